//! Calls from Python to what the command says: words and arrays in; JSON, arrays and files out.

use dropcheck::data::{Analysis, HeldSamples};
use dropcheck::{command, ingest, report};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::ThreadPool;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

pyo3::create_exception!(
    dropcheck,
    Error,
    PyException,
    "What is wrong with a file, its content or what was asked, in the words of the command: where, and how \
     to mend it."
);

/// The exit status of a Rust program that broke off.
const BROKE_OFF: u8 = 101;

/// The threads that share the work, and the process that they belong to: a forked one has none of its
/// parent's.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

fn pool() -> Result<Arc<ThreadPool>, miette::Report> {
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((owner, pool)) = held.take() {
        if owner == process::id() {
            *held = Some((owner, Arc::clone(&pool)));
            return Ok(pool);
        }
        // To end it would wait for threads that are not there.
        std::mem::forget(pool);
    }
    let pool = rayon::ThreadPoolBuilder::new().build();
    let pool = Arc::new(pool.map_err(|refusal| miette::miette!("no threads could be started: {refusal}"))?);
    *held = Some((process::id(), Arc::clone(&pool)));
    Ok(pool)
}

/// Does `work` on the pool while Python goes on; a panic is an error like any other.
fn apart<T: Send>(py: Python, work: impl FnOnce() -> miette::Result<T> + Send) -> PyResult<T> {
    let done = py.detach(|| {
        let pool = pool()?;
        catch_unwind(AssertUnwindSafe(|| pool.install(work))).unwrap_or_else(|panic| {
            let said = panic.downcast_ref::<String>().cloned();
            let said = said.or_else(|| panic.downcast_ref::<&str>().map(|&said| said.to_owned()));
            Err(miette::miette!(
                help = "this is a defect of dropcheck: please report it with the recording and the cask file",
                "the analysis broke off: {}",
                said.unwrap_or_default()
            ))
        })
    });
    done.map_err(|complaint| Error::new_err(command::message(&complaint)))
}

/// A result and the curves beside it.
#[pyclass(frozen, name = "Analysis")]
struct Analysed(Analysis);

type Array<'py> = Bound<'py, PyArray1<f64>>;

#[pymethods]
impl Analysed {
    /// `result.json`.
    fn json<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let json = apart(py, || Ok(report::pretty_json(&self.0.result)?))?;
        Ok(PyBytes::new(py, &json))
    }

    /// Of each channel its name and its arrays by their names.
    fn curves<'py>(&self, py: Python<'py>) -> Vec<(String, BTreeMap<&'static str, Array<'py>>)> {
        let array = |values: &Vec<f64>| PyArray1::from_slice(py, values);
        let curve_arrays = |curve: &dropcheck::data::ChannelCurve| {
            let arrays = BTreeMap::from([
                ("time_s", array(&curve.time_s)),
                ("raw_m_s2", array(&curve.raw_m_s2)),
                ("filtered_m_s2", array(&curve.filtered_m_s2)),
                ("velocity_m_s", array(&curve.velocity_m_s)),
            ]);
            (curve.channel.clone(), arrays)
        };
        self.0.curves.channels.iter().map(curve_arrays).collect()
    }

    /// The motion of the rigid body, array by array as in `curves.csv`.
    fn motion<'py>(&self, py: Python<'py>) -> Vec<(&'static str, Array<'py>)> {
        let Some(motion) = &self.0.curves.motion else { return Vec::new() };
        let angle_deg = motion.angle_rad.iter().map(|angle| angle.to_degrees()).collect();
        let arrays = [
            ("time_s", &motion.time_s),
            ("angle_deg", &angle_deg),
            ("angular_velocity_rad_s", &motion.angular_velocity_rad_s),
            ("vertical_velocity_first_m_s", &motion.first_end_vertical_m_s),
            ("vertical_velocity_second_m_s", &motion.second_end_vertical_m_s),
            ("horizontal_velocity_second_m_s", &motion.second_end_horizontal_m_s),
            ("height_first_m", &motion.first_end_height_m),
            ("height_second_m", &motion.second_end_height_m),
        ];
        arrays.into_iter().map(|(name, values)| (name, PyArray1::from_slice(py, values))).collect()
    }

    /// Writes the report into a folder.
    fn write(&self, py: Python, folder: PathBuf) -> PyResult<()> {
        apart(py, || command::write(&self.0, &folder))
    }
}

/// Samples as Python hands them over.
#[derive(FromPyObject)]
struct Given<'py> {
    values: PyReadonlyArray1<'py, f64>,
    times_s: Option<PyReadonlyArray1<'py, f64>>,
    rate_hz: Option<f64>,
    unit: Option<String>,
    start_s: f64,
}

impl Given<'_> {
    fn held(&self, name: String) -> HeldSamples {
        HeldSamples {
            name,
            values: self.values.as_array().to_vec(),
            sample_rate_hz: self.rate_hz,
            unit: self.unit.clone(),
            times_s: self.times_s.as_ref().map(|times| times.as_array().to_vec()),
            start_s: self.start_s,
        }
    }
}

/// What `analyze` says to these words, of arrays in place of a file where there are any.
#[pyfunction]
fn analyze(py: Python, words: Vec<OsString>, given: Option<Vec<(String, Given)>>) -> PyResult<Analysed> {
    let held = given.map(|given| given.into_iter().map(|(name, given)| given.held(name)).collect::<Vec<_>>());
    apart(py, || command::analysis(&words, held.as_deref())).map(Analysed)
}

/// The JSON of `predict`.
#[pyfunction]
fn predict(py: Python<'_>, words: Vec<OsString>) -> PyResult<Bound<'_, PyBytes>> {
    apart(py, || command::prediction(&words)).map(|json| PyBytes::new(py, &json))
}

/// The JSON of `inspect`.
#[pyfunction]
fn inspect(py: Python<'_>, recording: PathBuf) -> PyResult<Bound<'_, PyBytes>> {
    apart(py, || command::listing(&recording)).map(|json| PyBytes::new(py, &json))
}

/// The files that `synth` writes: recording, cask file, truth.
#[pyfunction]
fn synth(py: Python, words: Vec<OsString>) -> PyResult<[PathBuf; 3]> {
    apart(py, || command::synthetic(&words))
}

/// Runs the command, and returns its exit status.
#[pyfunction]
fn main(py: Python, words: Vec<OsString>) -> u8 {
    py.detach(|| catch_unwind(|| command::main(&words)).unwrap_or(BROKE_OFF))
}

/// Names the program that takes HDF5 files apart: an interpreter that calls `take_hdf5_apart`.
#[pyfunction]
fn read_hdf5_by(path: PathBuf, words: Vec<OsString>, variables: Vec<(OsString, OsString)>) {
    ingest::read_hdf5_by(ingest::Hdf5Program { path, words, variables });
}

/// Takes an HDF5 file apart until nobody asks any more, and ends the process.
#[pyfunction]
fn take_hdf5_apart(py: Python, path: PathBuf) {
    let could = py.detach(|| ingest::take_hdf5_apart(&path));
    process::exit(i32::from(!could));
}

/// Has the package convert a file of another format by the library of its field.
fn converted(path: &Path, format: &str, into: &Path) -> Result<String, [String; 3]> {
    let said: PyResult<Vec<String>> = Python::attach(|py| {
        let package = py.import("dropcheck._foreign")?;
        package.call_method1("into_hdf5", (path.to_str(), format, into.to_str()))?.extract()
    });
    match said.map(|mut said| said.pop().map(|last| (last, said))) {
        Ok(Some((reader, before))) if before.is_empty() => Ok(reader),
        Ok(Some((mend, before))) => {
            Err([before[0].clone(), before.last().cloned().unwrap_or_default(), mend])
        }
        Ok(None) => Err(Default::default()),
        Err(fault) => Err(["the module".to_owned(), fault.to_string(), "please report it".to_owned()]),
    }
}

/// The word for the format of a file that a library of its field reads; what else it is, is an error.
#[pyfunction]
fn foreign_format(path: PathBuf) -> PyResult<&'static str> {
    ingest::foreign_format(&path).ok_or_else(|| {
        let own = ingest::format(&path).map(|_| "dropcheck reads it itself: hand its name to `analyze`");
        let said = own.map_or_else(Into::into, |own| miette::miette!("{}: {own}", path.display()));
        Error::new_err(command::message(&said))
    })
}

/// SHA-256 of a file, as results have it.
#[pyfunction]
fn sha256(py: Python, path: PathBuf) -> PyResult<String> {
    apart(py, || Ok(ingest::sha256(&path)?))
}

/// Whether an attribute of this name says how counts become a physical quantity.
#[pyfunction]
fn is_conversion(name: &str) -> bool {
    ingest::is_conversion(name)
}

/// The extension behind the package `dropcheck`.
#[pymodule]
fn _dropcheck(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<Error>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<Analysed>()?;
    module.add_function(wrap_pyfunction!(analyze, module)?)?;
    module.add_function(wrap_pyfunction!(predict, module)?)?;
    module.add_function(wrap_pyfunction!(inspect, module)?)?;
    module.add_function(wrap_pyfunction!(synth, module)?)?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(foreign_format, module)?)?;
    module.add_function(wrap_pyfunction!(sha256, module)?)?;
    module.add_function(wrap_pyfunction!(is_conversion, module)?)?;
    ingest::read_foreign_by(converted);
    module.add_function(wrap_pyfunction!(read_hdf5_by, module)?)?;
    module.add_function(wrap_pyfunction!(take_hdf5_apart, module)?)
}
