//! What an exhibit comes to: tables, charts and the gains that must not fall.

use crate::table::Table;

/// What an exhibit shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Its tables.
    pub tables: Vec<Table>,
    /// Charts and pictures for the page.
    pub html: String,
    /// Gains that the guard looks at, by name.
    pub gains: Vec<(String, f64)>,
}

impl Drawn {
    /// Whether anything was made of it.
    pub fn has_something(&self) -> bool {
        !self.html.is_empty() || self.tables.iter().any(|table| !table.rows.is_empty())
    }
}
