//! The paper's own figures (Knodt et al. 2023, Tables 2, 3, 5, 6, 7, 8, 10, 11, Figure 5), as far as our copy of
//! it is legible: PSNR in dB and MS-SSIM over 48 views.
//!
//! `paper.tsv` has a line for each: table, model as the paper calls it, texture size, method.
//! NV is NVDiffModeling, UE the Unreal Engine; letters after *Ours* say what moves.

use std::sync::OnceLock;

/// One of the paper's results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperFigure {
    /// Decibels.
    pub psnr: f64,
    /// 0 … 1.
    pub ms_ssim: f64,
}

/// A line of the file.
struct Line {
    table: u8,
    model: &'static str,
    size: usize,
    method: &'static str,
    figure: PaperFigure,
}

fn lines() -> &'static [Line] {
    static LINES: OnceLock<Vec<Line>> = OnceLock::new();
    LINES.get_or_init(|| include_str!("paper.tsv").lines().skip(1).filter_map(line).collect())
}

fn line(text: &'static str) -> Option<Line> {
    let mut parts = text.split('\t');
    Some(Line {
        table: parts.next()?.parse().ok()?,
        model: parts.next()?,
        size: parts.next()?.parse().ok()?,
        method: parts.next()?,
        figure: PaperFigure { psnr: parts.next()?.parse().ok()?, ms_ssim: parts.next()?.parse().ok()? },
    })
}

/// What the paper has for a model of ours, named as its folder or file is.
pub fn figure(table: u8, name: &str, size: usize, method: &str) -> Option<PaperFigure> {
    lines()
        .iter()
        .find(|l| l.table == table && l.size == size && l.method == method && is_called(name, l.model))
        .map(|l| l.figure)
}

/// What the paper counts of a model (Table 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PaperCounts {
    /// Pieces of the mesh that share vertices.
    pub components: usize,
    /// Vertices, split at seams of the texture.
    pub vertices: usize,
    /// Triangles.
    pub faces: usize,
}

/// Table 5: what the paper counts of a model of ours; `level` is 1, 2 or 3, and 0 for the high-poly. In our copy the
/// names of LOD-3's first seven rows are one row off; its figures are in the order of the other columns, which the
/// files of the hand fan confirm.
pub fn counts(name: &str, level: u8) -> Option<PaperCounts> {
    include_str!("paper_dataset.tsv").lines().skip(1).find_map(|line| {
        let parts: Vec<&str> = line.split('\t').collect();
        let number = |k: usize| parts.get(k)?.parse::<usize>().ok();
        (number(1)? == usize::from(level) && is_called(name, parts[0])).then_some(PaperCounts {
            components: number(2)?,
            vertices: number(3)?,
            faces: number(4)?,
        })
    })
}

/// The table of Figure 5: high-polys, then levels from fine to coarse; components, vertices and faces, manifold
/// models, genus, holes. Three numbers are the least, the median and the greatest.
pub const DATASET: [[&str; 7]; 4] = [
    [
        "High-poly",
        "8 / 225 / 2k",
        "502 / 8k / 70k",
        "723 / 9k / 0.1M",
        "5 of 26",
        "0 / 0 / 0",
        "0 / 29 / 174",
    ],
    ["LOD-1", "1 / 41 / 312", "244 / 1k / 5k", "306 / 1k / 5k", "24 of 26", "0 / 3 / 39", "0"],
    ["LOD-2", "1 / 19 / 82", "43 / 354 / 1k", "64 / 406 / 1k", "26 of 26", "0 / 2 / 28", "0"],
    ["LOD-3", "1 / 6 / 40", "28 / 114 / 349", "32 / 137 / 368", "26 of 26", "0 / 0 / 12", "0"],
];

/// Table 2: the paper's method, texture size, milliseconds an iteration, iterations.
pub const TIMINGS: [(&str, usize, f64, f64); 7] = [
    ("NV", 128, 245.0, 1183.0),
    ("NV", 256, 242.0, 1105.0),
    ("NV", 512, 244.0, 1050.0),
    ("Ours_UV,SH", 128, 448.0, 4504.0),
    ("Ours_UV,SH", 256, 450.0, 4504.0),
    ("Ours_UV,SH", 512, 607.0, 4504.0),
    ("Ours", 512, 608.0, 4504.0),
];

/// Pictures whose file names say something else than the paper does.
const PICTURES: [(&str, &str); 6] = [
    ("alias_test", "Aliasing"),
    ("cloud512", "Cloud"),
    ("mucha_zodiac", "Painting"),
    ("nav1", "Sea Map"),
    ("rainforest_white_border", "Rainforest"),
    ("hokusai", "Hokusai"),
];

/// Words that the paper cuts short in a way that is no beginning.
const SHORT: [(&str, &str); 2] = [("chn", "chinese"), ("jpn", "japanese")];

/// Whether a folder or file is what the paper calls `model`: each of its words begins one of the
/// name's words.
fn is_called(name: &str, model: &str) -> bool {
    if let Some((_, called)) = PICTURES.iter().find(|(stem, _)| *stem == name) {
        return *called == model;
    }
    let words = |text: &str| -> Vec<String> {
        text.to_lowercase().split(|c: char| !c.is_alphanumeric()).map(String::from).collect()
    };
    let ours = words(name);
    words(model).iter().filter(|word| !word.is_empty()).all(|word| {
        let whole = SHORT.iter().find(|(short, _)| short == word).map(|(_, whole)| *whole);
        ours.iter().any(|own| own.starts_with(word.as_str()) || whole.is_some_and(|w| own.starts_with(w)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the comparison from another model's figures, and from a file that no longer reads.
    #[test]
    fn names_lead_to_their_figures() {
        assert_eq!(lines().len(), include_str!("paper.tsv").lines().count() - 1);
        let psnr = |table, name, size, method| figure(table, name, size, method).map(|f| f.psnr);
        assert_eq!(psnr(10, "chinese_hand_fan", 512, "Ours"), Some(27.89));
        assert_eq!(psnr(10, "lego_figure", 128, "NV"), Some(23.55));
        assert_eq!(psnr(10, "easter_egg_from_kaunas", 512, "Ours"), Some(26.83));
        assert_eq!(psnr(10, "chinese_chess", 512, "Ours"), Some(28.22));
        assert_eq!(psnr(7, "mask", 256, "Ours_UV"), Some(49.38));
        assert_eq!(psnr(6, "nav1", 64, "NV"), Some(16.17));
        assert_eq!(psnr(3, "cloud512", 64, "without"), Some(32.19));
        assert_eq!(psnr(10, "my_own_model", 512, "Ours"), None);
        assert_eq!(psnr(10, "mask", 1024, "Ours"), None);
        let counted = |name, level| counts(name, level).map(|c| (c.components, c.vertices, c.faces));
        assert_eq!(counted("mask", 0), Some((102, 3165, 4082)));
        assert_eq!(counted("chinese_hand_fan", 3), Some((2, 31, 34)));
        assert_eq!(counted("chinese_chess", 2), Some((19, 269, 270)));
        assert_eq!(counted("my_own_model", 0), None);
        assert_eq!(include_str!("paper_dataset.tsv").lines().count(), 1 + 26 * 4);
    }
}
