//! Test files: small MCAP files made in memory, of every encoding and compression.
