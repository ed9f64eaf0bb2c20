//! Mutated texts and cask files through their readers, and times through the time base.

use super::tests::cask_file;
use super::*;
use crate::ingest::{cask_file as cask_files, fuzz};

#[test]
fn tables() {
    let seeds = [
        "time_s,A1 [g],A2 [g]\n0,1.5,2\n0.001,-3,4\n0.002,5e-3,\n",
        "\u{feff}Logger 7\n\nZeit;A1;A2\ns;g;g\n0,000;1,5;-2\n0,001;2,5;nan\n",
        "# x\n1\t2\t3\n2\t3\t4\n",
        "when,A1\n2026-01-01T00:00:00,1\n2026-01-01T00:00:01,2\n",
        "Datum;Zeit;A1\n31.12.2026;23:59:59,5;1\n01.01.2027;00:00:00,5;2\n",
        "Zeit\tA1\n31.12.2026 59:59.5\t1\n1/1/27 0:00:00\t2\n",
    ]
    .map(|text| text.as_bytes().to_vec());
    let words: [&[u8]; 16] = [
        b",",
        b";",
        b"\t",
        b"\n",
        b"\r\n",
        b"\"",
        b"\"\"",
        b"1e308",
        b"-",
        b"nan",
        b"0.001",
        b"2026-01-01T00:00:00Z",
        b"12:34:56,7",
        b"20.11.2026 ",
        b"A1",
        b"[g]",
    ];
    let limits = Limits::of_memory(0);
    let cask = cask_file(&["A1"]);
    fuzz::run("csv", &seeds, &words, |bytes| {
        match of_input(Path::new("r"), Input::of_bytes(bytes), &cask, (limits, &|_| ())) {
            Ok(raw) => format!(
                "{:?} {:?}",
                raw.issues,
                raw.channels.iter().map(|c| &c.uniform.issues).collect::<Vec<_>>()
            ),
            Err(error) => format!("{error:?}"),
        }
    });
}

#[test]
fn cask_file_texts() {
    let seeds = ["anf18-german", "vhlw-rest", "esbb-imu"]
        .map(|stem| std::fs::read(format!("{}/fixtures/{stem}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap());
    let words: [&[u8]; 14] = [
        b"[[channel]]\n",
        b"[cask]\n",
        b"mass_kg = ",
        b"= 1e999\n",
        b"= -1\n",
        b"= nan\n",
        b"[[[[",
        b"\"\"\"",
        b"{a = 1}",
        b"source = ",
        b"'",
        b"\\u0000",
        b"unit = \"mV\"\n",
        b"angle_deg = 90\n",
    ];
    fuzz::run("cask", &seeds, &words, |bytes| {
        match cask_files::checked(Path::new("c"), &String::from_utf8_lossy(bytes)) {
            Ok(cask) => format!("{:?} {}", cask.contact, cask.channels.len()),
            Err(error) => error.to_string(),
        }
    });
}

#[test]
fn times() {
    let seeds = [[0.0, 1e-3, 2e-3, 3e-3, 7e-3, 8e-3], [0.0, 1.0, 1.0, 0.5, 1e9, f64::NAN]]
        .map(|times_s| times_s.iter().flat_map(|t: &f64| t.to_le_bytes()).collect::<Vec<u8>>());
    let words: [&[u8]; 3] = [&[0; 8], &[0, 0, 0, 0, 0, 0, 0xf0, 0x7f], &[0xff; 8]];
    fuzz::run("times", &seeds, &words, |bytes| {
        let (words, _) = bytes.as_chunks::<8>();
        let times_s: Vec<f64> = words.iter().map(|&word| f64::from_le_bytes(word)).collect();
        let samples = Samples::F64(times_s.iter().map(|t| t * 2.0).collect());
        let by_times = time_base::from_times(&times_s, samples, None);
        let blocks = times_s.windows(2).map(|pair| time_base::Block {
            start_s: pair[0],
            sample_rate_hz: pair[1],
            count: 3,
        });
        let blocks: Vec<_> = blocks.collect();
        let three = Samples::F32([1.0, f32::NAN, 3.0].repeat(blocks.len()));
        let by_blocks = time_base::from_blocks(&blocks, three);
        let ends = [by_times, by_blocks].map(|end| match end {
            Ok(uniform) => format!("{:?}", uniform.issues.iter().map(|issue| issue.code).collect::<Vec<_>>()),
            Err(error) => format!("{error:?}"),
        });
        ends.concat()
    });
}
