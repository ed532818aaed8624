//! A high-poly that is prepared once.

use crate::small_pair;
use parbake::{BakeError, BakeOptions, Convention, Preset, bake, bake_prepared, prepare_high_poly};
use parbake::{Message, Stage, Watcher};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Counts the reference views that are rendered.
#[derive(Default)]
struct Counter(AtomicUsize);

impl Watcher for Counter {
    fn message(&self, message: Message) {
        if matches!(message, Message::Progress { stage: Stage::Reference, .. }) {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
    }
}

fn quick() -> BakeOptions {
    BakeOptions {
        texture_size: 32,
        preset: Preset::Fast,
        views: Some(12),
        view_size: Some(48),
        rounds: Some(1),
        ..BakeOptions::default()
    }
}

/// Protects chains of levels: a prepared high-poly gives the same bytes as a bake that prepares its own,
/// and the second low-poly has no view rendered again.
#[test]
fn views_are_rendered_once_for_any_number_of_low_polys() {
    let (high, low) = small_pair();
    let prepared = prepare_high_poly(&high, &quick()).expect("the demo has an extent");
    let (first, second) = (Counter::default(), Counter::default());
    let own = bake(&high, &low, &quick(), &()).expect("the pair can be baked");
    for counter in [&first, &second] {
        let baked = bake_prepared(&prepared, &low, &quick(), counter).expect("the pair can be baked");
        assert!(baked.model == own.model);
    }
    assert!(first.0.load(Ordering::Relaxed) > 0);
    assert_eq!(second.0.load(Ordering::Relaxed), 0);
}

/// Protects from a silent mismatch: a high-poly that was prepared for one convention is not compared by
/// another.
#[test]
fn another_convention_is_refused() {
    let (high, low) = small_pair();
    let prepared = prepare_high_poly(&high, &quick()).expect("the demo has an extent");
    let options = BakeOptions { convention: Convention::Paper, ..quick() };
    let refused = bake_prepared(&prepared, &low, &options, &());
    assert!(matches!(refused, Err(BakeError::OtherConventions { .. })));
}
