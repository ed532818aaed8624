//! A table as data, and as text for terminals, Markdown and HTML.
//!
//! Contract: all three show the same numbers; what was not measured is a dash, never a zero.

use parbake_report::page::text::{NOTHING, change, decimal, escape, verdict};

/// What stands in a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// PSNR in dB and MS-SSIM, measured here.
    Score(f64, Option<f64>),
    /// The same, the paper's.
    Paper(f64, f64),
    /// A gain in dB, measured here.
    Gain(f64),
    /// The paper's gain in dB.
    PaperGain(f64),
    /// The paper's number, with so many decimals.
    PaperNumber(f64, usize),
    /// Any number with so many decimals.
    Number(f64, usize),
    /// Words.
    Text(String),
    /// Not measured, or not in the paper.
    Missing,
}

impl Cell {
    /// A cell, or a dash.
    pub fn or_missing(cell: Option<Cell>) -> Cell {
        cell.unwrap_or(Cell::Missing)
    }

    fn text(&self) -> String {
        match self {
            Cell::Score(psnr, _) if !psnr.is_finite() => NOTHING.into(),
            Cell::Score(psnr, ssim) => match ssim {
                Some(ssim) => format!("{}/{}", decimal(*psnr, 2), decimal(*ssim, 3)),
                None => decimal(*psnr, 2),
            },
            Cell::Paper(psnr, ssim) => format!("{}/{}", decimal(*psnr, 2), decimal(*ssim, 3)),
            Cell::Gain(gain) | Cell::PaperGain(gain) => change(*gain, 2),
            Cell::Number(number, decimals) | Cell::PaperNumber(number, decimals) => {
                decimal(*number, *decimals)
            }
            Cell::Text(text) => text.clone(),
            Cell::Missing => NOTHING.into(),
        }
    }

    fn class(&self) -> &'static str {
        match self {
            Cell::Paper(..) | Cell::PaperGain(_) | Cell::PaperNumber(..) => "paper",
            Cell::Gain(gain) => verdict(*gain, 2, true),
            _ => "",
        }
    }
}

/// A table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// What it shows, in a line.
    pub caption: String,
    /// Heads of the columns; the first is that of the rows' names.
    pub columns: Vec<String>,
    /// Names of rows with their cells.
    pub rows: Vec<(String, Vec<Cell>)>,
}

impl Table {
    /// Without rows.
    pub fn new(caption: &str, columns: &[&str]) -> Self {
        Self {
            caption: caption.into(),
            columns: columns.iter().map(|c| (*c).into()).collect(),
            rows: Vec::new(),
        }
    }

    /// Appends a row, unless all of its cells are missing.
    pub fn push(&mut self, name: &str, cells: Vec<Cell>) {
        let is_papers =
            |cell: &Cell| matches!(cell, Cell::Paper(..) | Cell::PaperGain(_) | Cell::PaperNumber(..));
        if cells.iter().any(|cell| *cell != Cell::Missing && !is_papers(cell)) {
            self.rows.push((name.into(), cells));
        }
    }

    /// Appends a row of medians of the gains above; others stay empty.
    pub fn push_medians(&mut self, name: &str) {
        let columns = self.columns.len().saturating_sub(1);
        let cell = |k: usize| {
            let of = |theirs: bool| -> Vec<f64> {
                let cells = self.rows.iter().filter_map(|(_, cells)| cells.get(k));
                let gain = |cell: &Cell| match cell {
                    Cell::Gain(gain) if !theirs => Some(*gain),
                    Cell::PaperGain(gain) if theirs => Some(*gain),
                    _ => None,
                };
                cells.filter_map(gain).filter(|gain| gain.is_finite()).collect()
            };
            match (median(&of(false)), median(&of(true))) {
                (Some(gain), _) => Cell::Gain(gain),
                (_, Some(gain)) => Cell::PaperGain(gain),
                _ => Cell::Text(String::new()),
            }
        };
        let cells: Vec<Cell> = (0..columns).map(cell).collect();
        if self.rows.len() > 1 {
            self.rows.push((name.into(), cells));
        }
    }

    /// For a terminal: columns aligned.
    pub fn terminal(&self) -> String {
        let rows: Vec<Vec<String>> = std::iter::once(self.columns.clone()).chain(self.texts()).collect();
        let width = |k: usize| rows.iter().filter_map(|r| r.get(k)).map(|t| t.chars().count()).max();
        let widths: Vec<usize> = (0..self.columns.len()).map(|k| width(k).unwrap_or(0)).collect();
        let mut out = format!("{}\n", self.caption);
        for row in &rows {
            let mut line = String::new();
            for (k, (text, width)) in row.iter().zip(&widths).enumerate() {
                let gap = " ".repeat(width - text.chars().count());
                line += &if k == 0 { format!("{text}{gap}") } else { format!("  {gap}{text}") };
            }
            out += line.trim_end();
            out.push('\n');
        }
        out
    }

    /// For a document.
    pub fn markdown(&self) -> String {
        let line = |texts: &[String]| format!("| {} |\n", texts.join(" | "));
        let marks: Vec<String> =
            (0..self.columns.len()).map(|k| if k == 0 { "---" } else { "--:" }.into()).collect();
        let body: String = self.texts().iter().map(|row| line(row)).collect();
        format!("{}\n\n{}{}{body}", self.caption, line(&self.columns), line(&marks))
    }

    /// For the page.
    pub fn html(&self) -> String {
        let heads: String =
            self.columns.iter().map(|c| format!(r#"<th scope="col">{}</th>"#, escape(c))).collect();
        let row = |(name, cells): &(String, Vec<Cell>)| {
            let cells: String = (cells.iter())
                .map(|cell| format!(r#"<td class="{}">{}</td>"#, cell.class(), escape(&cell.text())))
                .collect();
            format!(r#"<tr><th scope="row">{}</th>{cells}</tr>"#, escape(name))
        };
        let rows: String = self.rows.iter().map(row).collect();
        format!(
            concat!(
                r#"<div class="wide"><table class="numbers-table"><caption>{}</caption>"#,
                "<thead><tr>{}</tr></thead><tbody>{}</tbody></table></div>"
            ),
            escape(&self.caption),
            heads,
            rows
        )
    }

    fn texts(&self) -> Vec<Vec<String>> {
        let row = |(name, cells): &(String, Vec<Cell>)| {
            std::iter::once(name.clone()).chain(cells.iter().map(Cell::text)).collect()
        };
        self.rows.iter().map(row).collect()
    }
}

/// The middle value; of an even count the mean of the two in the middle.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    (count > 0).then(|| 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects what a table says: every form has the same numbers, the paper's are marked, gaps
    /// are gaps, and names cannot break out.
    #[test]
    fn all_forms_say_the_same() {
        let mut table = Table::new("Gains", &["model", "ours", "paper", "gain", "paper's gain"]);
        let row = |psnr, gain| {
            vec![
                Cell::Score(psnr, Some(0.99)),
                Cell::Paper(25.0, 0.9),
                Cell::Gain(gain),
                Cell::PaperGain(1.0),
            ]
        };
        table.push("<a>", row(30.0, 2.0));
        table.push("b", row(31.5, -1.0));
        table.push("c", vec![Cell::Missing, Cell::Paper(1.0, 0.1), Cell::Missing, Cell::Missing]);
        table.push_medians("median");
        assert_eq!(table.rows.len(), 3, "a row without figures of ours is none");
        for text in [table.terminal(), table.markdown(), table.html()] {
            for part in ["30.00/0.990", "25.00/0.900", "+2.00", "−1.00", "+0.50", "+1.00"] {
                assert!(text.contains(part), "{part} in {text}");
            }
        }
        assert!(table.html().contains("&lt;a&gt;") && table.html().contains(r#"class="worse""#));
        let lines: Vec<usize> = table.terminal().lines().skip(1).map(|l| l.chars().count()).collect();
        assert_eq!(lines[0], lines[1]);
    }

    /// Protects medians of few.
    #[test]
    fn medians() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 9.0]), Some(3.0));
    }
}
