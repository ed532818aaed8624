//! The regression guard: gains may not fall below those on record without the record being
//! changed on purpose.
//!
//! Contract: a record is a JSON object from the names of gains to decibels, in the order of names.
//! What is not on record is no fall; what is on record and was not made is told, and no fall either:
//! not everybody has all of the data.

use crate::error::ReproduceError;
use std::collections::BTreeMap;
use std::path::Path;

/// Decibels that a gain may fall: another processor's mathematics may differ in the last digit, and
/// choices that hang on it in some hundredths of a decibel.
pub const TOLERANCE: f64 = 0.2;

/// Gains by name, in decibels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record(pub BTreeMap<String, f64>);

/// A gain that is not what it was.
#[derive(Clone, Debug, PartialEq)]
pub struct Fall {
    /// Whose.
    pub name: String,
    /// As recorded.
    pub recorded: f64,
    /// As measured; none where the experiment was not made.
    pub measured: Option<f64>,
}

impl Record {
    /// Reads a record.
    ///
    /// # Errors
    /// Where the file cannot be read or is no record.
    pub fn read(path: &Path) -> Result<Self, ReproduceError> {
        let text = std::fs::read(path).map_err(ReproduceError::disk(path))?;
        serde_json::from_slice(&text).map(Self).map_err(|e| ReproduceError::Format {
            path: path.into(),
            what: "record of gains",
            reason: e.to_string(),
        })
    }

    /// As text: hundredths of a decibel, so that a change of the record shows what changed.
    pub fn text(&self) -> String {
        let rounded: BTreeMap<&str, f64> =
            self.0.iter().map(|(name, gain)| (name.as_str(), (gain * 100.0).round() / 100.0)).collect();
        serde_json::to_string_pretty(&rounded).unwrap_or_default() + "\n"
    }

    /// Gains that fell by more than is tolerated, or are missing.
    pub fn falls(&self, measured: &Record) -> Vec<Fall> {
        let fall = |(name, recorded): (&String, &f64)| {
            let now = measured.0.get(name).copied();
            let fell = now.is_none_or(|now| now.is_nan() || now < recorded - TOLERANCE);
            fell.then(|| Fall { name: name.clone(), recorded: *recorded, measured: now })
        };
        self.0.iter().filter_map(fall).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(gains: &[(&str, f64)]) -> Record {
        Record(gains.iter().map(|(name, gain)| ((*name).into(), *gain)).collect())
    }

    /// Protects users from a loss of quality that nobody notices.
    #[test]
    fn falls_are_found() {
        let old = record(&[("a", 3.0), ("b", 2.0), ("c", 1.0), ("d", 0.0)]);
        let new = record(&[("a", 2.81), ("b", 1.79), ("d", f64::NAN), ("e", -5.0)]);
        let falls = old.falls(&new);
        let names: Vec<&str> = falls.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["b", "c", "d"]);
        assert_eq!(falls[1].measured, None);
        assert!(old.falls(&old).is_empty());
    }

    /// Protects records from what cannot be read back.
    #[test]
    fn records_round_trip() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        std::fs::write(&path, record(&[("a", 1.234), ("b", -0.5)]).text()).unwrap();
        assert_eq!(Record::read(&path).unwrap(), record(&[("a", 1.23), ("b", -0.5)]));
        std::fs::write(&path, "[]").unwrap();
        assert!(Record::read(&path).unwrap_err().to_string().contains("record of gains"));
    }
}
