//! Who is told what a batch is doing, and may stop it.

/// What happens.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A job begins, or one has ended while others run.
    Running {
        /// How many are finished or have failed.
        done: usize,
        /// How many there are.
        total: usize,
        /// Those that run, by name.
        names: Vec<String>,
        /// Seconds that the rest will take, judged by those that ran; none at first.
        seconds_left: Option<f64>,
    },
    /// A job has ended.
    Ended {
        /// How many are finished or have failed.
        done: usize,
        /// How many there are.
        total: usize,
        /// Which one.
        name: String,
        /// What came of it in a few words.
        outcome: String,
        /// Whether it had been finished before.
        kept: bool,
        /// Whether it failed.
        failed: bool,
    },
}

/// Receives events.
pub trait Observer {
    /// Takes an event.
    fn event(&self, event: Event) {
        let _ = event;
    }

    /// True once no more jobs shall begin and those that run shall be given up.
    fn stopped(&self) -> bool {
        false
    }
}

/// Nobody watches.
impl Observer for () {}
