#!/bin/sh
# parallel.sh runs.csv campaign; with --sshloginfile nodes on other machines, which see the same folders
parallel dropcheck batch --manifest "$1" --out "$2" --shard {}/4 --jobs 1 --resume ::: 0 1 2 3
dropcheck merge "$2"/results-*-of-4.jsonl --out "$2"
