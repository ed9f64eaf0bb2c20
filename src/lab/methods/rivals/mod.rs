//! What a method of the program is held against: other methods for the same work, behind one name with it.

pub mod detector;
pub mod filter;
pub mod integration;
pub mod root;
pub mod shape;
