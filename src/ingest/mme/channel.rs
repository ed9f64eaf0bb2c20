//! A channel file of ISO-MME to its samples, with what its header states of them; what contradicts them is
//! refused by its line.

use super::files::MmeFiles;
use super::header::{HeadedText, HeaderLine};
use super::index::IndexedChannel;
use crate::data::{Finding, Samples, TableFinding};
use crate::ingest::time_base::{self, Uniform};
use crate::ingest::{IngestError, Limits, clock::Claims, lines, number, refusal::Refusal};
use crate::ingest::{statement::Statement, vocabulary::Meaning};
use crate::numerics::as_count;

/// Names of the lines that are applied.
const UNIT: &str = "Unit";
const CODE: &str = "Channel code";
const COUNT: &str = "Number of samples";
const INTERVAL: &str = "Sampling interval";
const START: &str = "Time of first sample";
const STATUS: &str = "Data status";
const REFERENCE: &str = "Reference channel";

/// What the status of samples holds that are not to be used (RED A of ISO/TS 13499).
const BAD: [&str; 4] = ["fail", "meaningless", "no data", "questionable"];

/// A channel file, read.
pub(super) struct ChannelFile<'a> {
    pub text: HeadedText<'a>,
    /// Missing ones are NaN.
    pub values: Vec<f64>,
    /// When the first was taken, s, where the file says so.
    pub start_s: Option<f64>,
    /// How the numbers ended.
    issues: Vec<Finding>,
}

impl<'a> ChannelFile<'a> {
    /// The file of a channel.
    ///
    /// # Errors
    /// It is not there, cannot be read, or contradicts itself or the index.
    pub(super) fn of(
        files: &'a MmeFiles,
        channel: &IndexedChannel,
        limits: Limits,
    ) -> Result<Self, IngestError> {
        let name = files.channels.get(&channel.number);
        let name = name.ok_or_else(|| files.without(&format!("Channel/….{:03}", channel.number)))?;
        let text = HeadedText::of(files, name, limits)?;
        let mut read = Self { text, values: Vec::new(), start_s: None, issues: Vec::new() };
        read.check(channel)?;
        read.start_s = read.number(START)?;
        read.values = read.numbers()?;
        read.hold_count()?;
        Ok(read)
    }

    /// The line of its unit.
    pub(super) fn unit(&self) -> Option<&HeaderLine> {
        self.text.line(UNIT)
    }

    fn check(&self, channel: &IndexedChannel) -> Result<(), IngestError> {
        let text = &self.text;
        let other =
            [UNIT, CODE, COUNT, INTERVAL, START, STATUS, REFERENCE].map(|name| text.contradiction(name));
        let other = other.into_iter().flatten().map(|line| (line, "a line above states another"));
        let code = text.line(CODE).filter(|line| line.value != channel.code);
        let code = code.map(|line| (line, "the index states another"));
        let is_bad = |line: &&HeaderLine| BAD.iter().any(|bad| line.value.to_lowercase().contains(bad));
        let status = text.line(STATUS).filter(is_bad).map(|line| (line, "samples of it are not to be used"));
        match other.chain(code).chain(status).next() {
            None => Ok(()),
            Some((line, why)) => {
                Err(text.fault(line.number, format!("{} is {:?}, and {why}", line.name, line.value)))
            }
        }
    }

    /// The number that a line states.
    fn number(&self, name: &str) -> Result<Option<f64>, IngestError> {
        let Some(line) = self.text.line(name) else { return Ok(None) };
        let number = line.value.parse().ok().filter(|number: &f64| number.is_finite());
        let problem = || format!("{name} is {:?}, which is no number", line.value);
        number.map(Some).ok_or_else(|| self.text.fault(line.number, problem()))
    }

    /// The numbers below the header, one a line.
    fn numbers(&self) -> Result<Vec<f64>, IngestError> {
        let (mut values, mut empty) = (Vec::new(), None);
        for (line, number) in self.text.rest.split_inclusive(|&byte| byte == b'\n').zip(self.text.above + 1..)
        {
            let cell = line.trim_ascii();
            let value = number::of_cell(cell, b'.').or_else(|| number::is_missing(cell).then_some(f64::NAN));
            match (value, empty) {
                _ if cell.is_empty() => empty = empty.or(Some(number)),
                (_, Some(empty)) => {
                    let problem = "it is empty, and numbers follow: NOVALUE stands for a missing one";
                    return Err(self.text.fault(empty, problem.into()));
                }
                (None, _) => {
                    let cell = lines::text(&cell[..cell.len().min(40)]);
                    let problem = format!("{cell:?} is no number with a decimal point, nor NOVALUE");
                    return Err(self.text.fault(number, problem));
                }
                (Some(value), _) => values.push(value),
            }
        }
        Ok(values)
    }

    /// Holds the numbers against the count that is stated; without it, or below it, a last line that is not
    /// ended was cut.
    fn hold_count(&mut self) -> Result<(), IngestError> {
        let stated = self.number(COUNT)?.map(as_count);
        let rows = self.values.len();
        let last = self.text.above + rows as u64;
        if let Some(stated) = stated.filter(|stated| *stated < rows) {
            return Err(self.text.fault(last, format!("it is number {rows}, and {COUNT} is {stated}")));
        }
        let is_short = stated != Some(rows);
        let is_cut = is_short && !self.text.rest.ends_with(b"\n") && self.values.pop().is_some();
        let cut = is_cut.then_some(TableFinding::CutLine { line: last });
        let zeros = self.text.has_zeros.then_some(TableFinding::ZeroBytes { line: last + 1 });
        let missing = |stated: usize| TableFinding::RowsMissing { stated: stated as u64, rows };
        let missing = stated.filter(|_| is_short).map(missing);
        self.issues.extend(zeros.or(cut).into_iter().chain(missing).map(Finding::from));
        Ok(())
    }

    /// The samples on their base, at the rate of the cask file or else of the interval.
    ///
    /// # Errors
    /// None of both states one, or too few samples are there.
    pub(super) fn placed(&mut self, cask_hz: Option<f64>) -> Result<Uniform, Refusal> {
        let line = self.text.line(INTERVAL);
        let stated = line.and_then(|line| Statement::of(INTERVAL, &line.value, Meaning::Interval(1.0)));
        let is_explicit = |line: &HeaderLine| line.value.eq_ignore_ascii_case("explicit");
        let is_explicit = self.text.line(REFERENCE).is_some_and(is_explicit);
        if cask_hz.is_none() && (stated.is_none() || is_explicit) {
            let said = line.map_or("not stated", |line| line.value.as_str());
            let said = format!("{INTERVAL} is {said}");
            let problem =
                if is_explicit { "its times stand in another channel, which is not read" } else { &said };
            let problem = format!("{}: {problem}", self.text.name);
            return Err(Refusal::new(problem, "give sample_rate_hz in this channel of the cask file"));
        }
        let claims = Claims { cask_hz, are_times_named: false, stated: stated.into_iter().collect() };
        let samples = Samples::F64(std::mem::take(&mut self.values));
        let placed = time_base::from_claims(self.start_s.unwrap_or_default(), &claims, samples);
        let mut uniform = placed.map_err(|refusal| refusal.at(self.text.name))?;
        uniform.issues.append(&mut self.issues);
        Ok(uniform)
    }
}
