//! From the built program, the sources and the fixtures to the promises that hold across modules.

mod campaign;
mod command_line;
mod compliant;
mod csv_times;
mod damage;
mod documents;
mod first_minutes;
mod fixtures;
mod golden;
mod hdf5_room;
mod house;
mod layouts;
mod odd;
mod predict_command;
mod properties;
mod reference;
mod relations;
mod run;
mod safety;
mod same;
mod short_flights;
mod synth;
mod tidy;
mod trial;
mod trial_drops;
mod uncertainty;
