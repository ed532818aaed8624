//! Who is told what a reproduction is doing, and may stop it.

/// What happens.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// An experiment begins.
    Begin {
        /// How many are finished.
        done: usize,
        /// How many there are.
        total: usize,
        /// Which one.
        title: String,
        /// Seconds that all the rest will take, judged by those that were made; none at first.
        seconds_left: Option<f64>,
    },
    /// An experiment was made, or had been made before.
    End {
        /// How many are finished.
        done: usize,
        /// How many there are.
        total: usize,
        /// Which one.
        title: String,
        /// Its figures in a few words.
        outcome: String,
        /// Whether it had been made before.
        kept: bool,
    },
    /// Something that the user should know and that stops nothing.
    Note(String),
    /// Tables and figures are being drawn.
    Drawing,
}

/// Receives events; called from one thread at a time, but asked from several.
pub trait Observer: Sync {
    /// Takes an event.
    fn event(&self, event: Event) {
        let _ = event;
    }

    /// True once no more experiments shall be begun and the one that runs shall be given up.
    fn stopped(&self) -> bool {
        false
    }
}

/// Nobody watches.
impl Observer for () {}
