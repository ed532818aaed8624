//! The ways in which levels are made, and what is known of one that was tried.

use serde::{Deserialize, Serialize};

/// How a level was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// Triangles were chosen by their pictures, the layout is new, maps were fitted.
    #[default]
    New,
    /// Edges of the model collapsed, its layout was repaired, maps were fitted.
    Delivered,
    /// Edges of the model collapsed; it has its own layout and its own maps, with fewer texels.
    Scaled,
}

/// A way that was tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// How.
    pub way: Way,
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of its largest texture.
    pub texture_size: usize,
    /// PSNR in dB against the original in pictures as viewers make them, the mean of the level's size and, up to 300
    /// pixels, twice that; before anything was compressed.
    pub psnr: f64,
    /// The same close up, where the model spans 300 pixels; none for levels of 150 pixels or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub close_up: Option<f64>,
}

/// What pictures of a level say of it, against the original's.
#[derive(Clone, Copy)]
pub(crate) struct Shown {
    /// PSNR in dB at the sizes that the level is made for, the mean.
    pub psnr: f64,
    /// PSNR in dB close up; none where that is one of these sizes.
    pub close_up: Option<f64>,
}

impl Candidate {
    pub(crate) fn shown(&self) -> Shown {
        Shown { psnr: self.psnr, close_up: self.close_up }
    }
}

impl Shown {
    /// Decibels more than another one's, at these sizes or close up, whichever is more.
    pub(crate) fn above(&self, other: &Self) -> f64 {
        let close_up = self.close_up.zip(other.close_up).map(|(own, other)| own - other);
        close_up.unwrap_or(f64::NEG_INFINITY).max(self.psnr - other.psnr)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects levels that are looked at from near: maps are worth their texels if they show at one of both sizes, and large levels
    /// have one size alone.
    #[test]
    fn maps_are_worth_what_they_show_somewhere() {
        let shown = |psnr, close_up| Shown { psnr, close_up };
        assert!((shown(36.1, Some(34.0)).above(&shown(36.0, Some(31.0))) - 3.0).abs() < 1e-9);
        assert!((shown(37.0, Some(31.0)).above(&shown(36.0, Some(31.0))) - 1.0).abs() < 1e-9);
        assert!((shown(37.0, None).above(&shown(36.0, None)) - 1.0).abs() < 1e-9);
    }
}
