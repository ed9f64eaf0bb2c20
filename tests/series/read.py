"""Read a campaign's tables with pandas and DuckDB, as they come, and hold them against one another.

    python3 tests/series/read.py CAMPAIGN RESULTS.jsonl
"""

import json
import sys
from pathlib import Path

import duckdb
import pandas as pd

campaign, lines = Path(sys.argv[1]), Path(sys.argv[2])
table = pd.read_csv(campaign / "campaign.csv")
of_json = pd.json_normalize(json.loads((campaign / "campaign.json").read_text())["recordings"])
of_lines = pd.json_normalize(pd.read_json(lines, lines=True).to_dict("records"))
assert list(table["id"]) == list(of_json["id"]) == list(of_lines["id"])

for column in ["slap_down_speed_m_s", "k", "k_u95", "drop.angle_deg", "cask.mass_kg", "impact_1_energy_absorbed_j"]:
    assert pd.api.types.is_float_dtype(table[column]) or pd.api.types.is_integer_dtype(table[column]), column
speed = of_json["slap_down_speed.value"]
assert (table["slap_down_speed_m_s"] - speed).abs().max() < 1e-12
assert (table["slap_down_speed_m_s"] - of_lines["slap_down.speed.value"]).abs().max() < 1e-12
assert (table["slap_down_flight_time_s"] - of_json["columns.slap_down_flight_time_s"]).abs().max() < 1e-12
assert table["error"].notna().sum() == (table["exit"] == 2).sum() > 0

rows = duckdb.sql(f"""select id, k from read_csv('{campaign / "campaign.csv"}') where k is not null order by id""").fetchall()
known = table[table["k"].notna()].sort_values("id")
assert [row[0] for row in rows] == list(known["id"]) and all(abs(a[1] - b) < 1e-12 for a, b in zip(rows, known["k"]))
(count,), = duckdb.sql(f"""select count(slap_down.speed.value) from read_json('{lines}')""").fetchall()
assert count == len(known), (count, len(known))
print("read by pandas and DuckDB:", len(table), "rows,", len(table.columns), "columns")
