//! An analysis to bytes: table, JSON, HTML, pictures, curves. Nothing here writes a file.
