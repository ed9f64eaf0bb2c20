# The commands that one uses every day: just NAME. CONTRIBUTING.md has the others.

# The first example to a report in report/.
try:
    cargo run -- analyze fixtures/examples/anf18-json.mcap --cask fixtures/examples/anf18-json.toml --out report

# What a change must keep; `just test tidy house` runs the tests of these names alone.
test *names:
    cargo test --locked {{ if names == "" { "" } else { "--test it -- " + names } }}

# All that a change must pass.
check:
    .ci/run

# Recorded answers anew: read the difference before it is committed.
bless:
    BLESS=1 cargo test --test it -- golden odd:: same:: --include-ignored
    BLESS=1 cargo test --test it -- documents
    git diff --stat tests fixtures docs

# Speed against the last commit that was measured.
bench *names:
    cargo bench {{ names }}
