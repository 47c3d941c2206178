//! The list of what is known not to be right yet. It must be true both ways: nothing worse than listed, and nothing
//! listed that is right by now.

use std::path::Path;

use serde::Deserialize;

use super::SetReport;

/// One entry of the list.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Listed {
    /// The set's name, such as `toi` or `stream/rl_13c2`.
    pub file: String,
    /// The category.
    pub category: String,
    /// How many records of it are short.
    pub count: Count,
    /// Which part of the work will mend it.
    pub part: String,
    /// Why it is short.
    pub reason: String,
}

/// How many records are short.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
pub enum Count {
    /// So many.
    Number(usize),
    /// Every record of the category, in whatever folder: a question that is not answered at all yet.
    All(All),
}

/// The word `all`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum All {
    /// Every record.
    All,
}

/// What is known not to be right yet.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// The entries.
    #[serde(default)]
    shortfall: Vec<Listed>,
}

/// Why a list cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum KnownError {
    /// It cannot be read.
    #[error("{path}: {source}")]
    Io {
        /// Which file.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// It is not such a list.
    #[error("{path}: {reason}")]
    Format {
        /// Which file.
        path: String,
        /// What is wrong.
        reason: String,
    },
}

/// Where list and report differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mismatch(pub String);

impl Known {
    /// Reads a list.
    ///
    /// # Errors
    /// The file cannot be read, is no such list, or lists a category twice or with a count of 0.
    pub fn read(path: &Path) -> Result<Self, KnownError> {
        let shown = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|source| KnownError::Io { path: shown.clone(), source })?;
        Self::parse(&text).map_err(|reason| KnownError::Format { path: shown, reason })
    }

    fn parse(text: &str) -> Result<Self, String> {
        let known: Self = toml::from_str(text).map_err(|error| error.to_string())?;
        for (index, entry) in known.shortfall.iter().enumerate() {
            if entry.count == Count::Number(0) {
                return Err(format!("{} {}: a count of 0 is no shortfall", entry.file, entry.category));
            }
            let same = |other: &Listed| other.file == entry.file && other.category == entry.category;
            if known.shortfall[..index].iter().any(same) {
                return Err(format!("{} {} is listed twice", entry.file, entry.category));
            }
        }
        Ok(known)
    }

    /// What of a set's report is not as listed, in either direction.
    #[must_use]
    pub fn compare(&self, report: &SetReport) -> Vec<Mismatch> {
        if report.note.is_some() {
            return Vec::new();
        }
        let entries = || self.shortfall.iter().filter(|entry| entry.file == report.name);
        let mut mismatches = Vec::new();
        for (name, category) in &report.categories {
            let listed = entries().find(|entry| entry.category == *name);
            let allowed = match listed.map(|entry| entry.count) {
                None => 0,
                Some(Count::Number(count)) => count,
                Some(Count::All(All::All)) => category.count,
            };
            let short = category.short;
            let place = format!("{} {name}", report.name);
            if short > allowed {
                mismatches.push(Mismatch(format!("{place}: {short} short, {allowed} known")));
            } else if short < allowed {
                mismatches.push(Mismatch(format!(
                    "{place}: {short} short, but {allowed} are listed: the list is out of date"
                )));
            }
        }
        for entry in entries().filter(|entry| !report.categories.contains_key(&entry.category)) {
            mismatches.push(Mismatch(format!(
                "{} {} is listed, but the set has no such category",
                entry.file, entry.category
            )));
        }
        mismatches
    }

    /// The entry of a category, to be shown beside it.
    #[must_use]
    pub fn entry(&self, set: &str, category: &str) -> Option<&Listed> {
        self.shortfall.iter().find(|entry| entry.file == set && entry.category == category)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::check::{CategoryReport, FaultKind, Outcome};

    fn report(short: u64, right: u64) -> SetReport {
        let mut category = CategoryReport::default();
        for index in 0..short + right {
            let mut outcome = Outcome::default();
            if index < short {
                outcome.fault(FaultKind::Value, "off");
            }
            category.add(index, outcome, Duration::ZERO, 0);
        }
        SetReport { name: "toi".to_owned(), categories: [("rotating".to_owned(), category)].into(), note: None }
    }

    fn known(count: &str) -> Known {
        let entry = format!("[[shortfall]]\nfile='toi'\ncategory='rotating'\ncount={count}\npart='2'\nreason='r'\n");
        Known::parse(&entry).expect("a list")
    }

    #[test]
    fn the_list_must_be_true_both_ways() {
        assert_eq!(known("3").compare(&report(3, 5)), vec![]);
        assert_eq!(known("3").compare(&report(4, 5)).len(), 1, "worse than listed");
        assert_eq!(known("3").compare(&report(2, 5)).len(), 1, "better than listed");
        assert_eq!(Known::default().compare(&report(1, 5)).len(), 1, "not listed");
        assert_eq!(Known::default().compare(&report(0, 5)), vec![]);
        assert_eq!(known("'all'").compare(&report(7, 0)), vec![]);
        assert_eq!(known("'all'").compare(&report(7, 1)).len(), 1, "one is right by now");
        let mut other = report(0, 1);
        other.categories.clear();
        assert_eq!(known("3").compare(&other).len(), 1, "no such category");
        other.name = "other".to_owned();
        assert_eq!(known("3").compare(&other), vec![], "sets that were not read cannot be judged");
    }

    #[test]
    fn malformed_lists_are_refused() {
        assert!(Known::parse("[[shortfall]]\nfile='toi'\n").is_err());
        assert!(Known::parse("[[short]]\n").is_err());
        let entry = "[[shortfall]]\nfile='toi'\ncategory='a'\ncount=1\npart='2'\nreason='r'\n";
        assert!(Known::parse(&entry.repeat(2)).is_err_and(|reason| reason.contains("twice")));
        assert!(Known::parse(&entry.replace("=1", "=0")).is_err());
    }
}
