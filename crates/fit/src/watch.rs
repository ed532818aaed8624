//! How a long run tells of itself and is stopped: messages out, one question in.
//! The library never prints; front ends draw.

/// What is being worked on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Moving vertices.
    Shape,
    /// Rendering the high-poly for the fit.
    Reference,
    /// Projecting the high-poly's surface onto the texture.
    Start,
    /// Finding where each pixel falls on the texture.
    Sampling,
    /// Fitting the cutout.
    Cutout,
    /// Fitting the parallax map.
    Parallax,
    /// Solving for the textures.
    Solve,
}

/// Receives messages; may be called from several threads at once.
pub trait Watch: Sync {
    /// `done` of `total` steps of this stage are finished.
    fn progress(&self, stage: Stage, done: usize, total: usize) {
        let _ = (stage, done, total);
    }

    /// True once the run shall end with the best state so far.
    fn should_stop(&self) -> bool {
        false
    }
}

/// Nobody watches.
impl Watch for () {}
