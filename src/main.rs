//! The command line of dropcheck.
fn main() {}
