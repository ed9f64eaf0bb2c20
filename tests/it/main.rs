//! From the built program, the sources and the fixtures to the promises that hold across modules.

mod arrays;
mod batch;
mod bounds;
mod campaign;
/// The command line once more, where it can name nothing but what every program can.
#[allow(dead_code, unused_imports, reason = "it is only compiled")]
#[path = "../../src/cli/mod.rs"]
mod cli;
mod command_line;
mod compliant;
mod csv_times;
mod damage;
mod documents;
mod filter;
mod first_minutes;
mod fixtures;
mod golden;
mod hdf5_room;
mod house;
mod impacts;
mod layouts;
mod odd;
mod predict_command;
mod properties;
mod record;
mod reference;
mod relations;
mod run;
mod safety;
mod same;
mod short_flights;
mod slips;
mod stages;
mod stored;
mod synth;
mod tidy;
mod trial;
mod uncertainty;
