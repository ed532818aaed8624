//! What the machine can do at most: the ceilings that `docs/performance.md` compares
//! the stages with.
//!
//! Memory: a sum over, and a triad `a = b + s · c` on, arrays many times the size of
//! the caches; bytes are those that the program names (a write may cost the machine a
//! read more). Arithmetic: independent chains of multiply and add in registers, four
//! lanes wide as the default target's SSE2 has them, and one lane wide; items are
//! single-precision operations. Each on one thread and on all.

use divan::Bencher;
use divan::counter::{BytesCount, ItemsCount};
use parbake_model::glam::Vec4;
use std::hint::black_box;
use std::thread::{available_parallelism, scope};

/// Numbers in each array: 96 MiB.
const NUMBERS: usize = 24 << 20;

/// Multiply-add steps of each chain.
const STEPS: usize = 1 << 20;

/// Enough chains to hide the latency of both units, and few enough for 16 registers.
const CHAINS: usize = 12;

fn main() {
    divan::main();
}

/// How many threads a bench runs on.
#[derive(Clone, Copy, Debug)]
enum Threads {
    One,
    All,
}

impl Threads {
    fn count(self) -> usize {
        match self {
            Threads::One => 1,
            Threads::All => available_parallelism().map_or(1, |n| n.get()),
        }
    }
}

#[divan::bench(args = [Threads::One, Threads::All], sample_size = 1, sample_count = 20)]
fn memory_read(bencher: Bencher, threads: Threads) {
    let numbers = vec![1u64; NUMBERS / 2];
    let share = numbers.len().div_ceil(threads.count());
    // Whole numbers: their sum may be taken in any order, so it is vectorised.
    bencher.counter(BytesCount::new(4 * NUMBERS)).bench_local(|| {
        scope(|s| {
            for part in numbers.chunks(share) {
                s.spawn(move || black_box(part.iter().fold(0u64, |sum, x| sum.wrapping_add(*x))));
            }
        });
    });
}

#[divan::bench(args = [Threads::One, Threads::All], sample_size = 1, sample_count = 20)]
fn memory_triad(bencher: Bencher, threads: Threads) {
    let (mut a, b, c) = (vec![0f32; NUMBERS], vec![1f32; NUMBERS], vec![2f32; NUMBERS]);
    let share = NUMBERS.div_ceil(threads.count());
    bencher.counter(BytesCount::new(12 * NUMBERS)).bench_local(|| {
        scope(|s| {
            for (a, (b, c)) in a.chunks_mut(share).zip(b.chunks(share).zip(c.chunks(share))) {
                s.spawn(move || {
                    for (a, (b, c)) in a.iter_mut().zip(b.iter().zip(c)) {
                        *a = b + 0.5 * c;
                    }
                });
            }
        });
    });
}

#[divan::bench(args = [Threads::One, Threads::All], sample_size = 1, sample_count = 20)]
fn multiply_add_four_lanes(bencher: Bencher, threads: Threads) {
    let operations = threads.count() * STEPS * CHAINS * 4 * 2;
    bencher.counter(ItemsCount::new(operations)).bench_local(|| {
        scope(|s| {
            for _ in 0..threads.count() {
                s.spawn(|| {
                    let (factor, term) = (black_box(Vec4::splat(0.999)), black_box(Vec4::splat(0.001)));
                    let mut chains = black_box([Vec4::ONE; CHAINS]);
                    for _ in 0..STEPS {
                        for x in &mut chains {
                            *x = *x * factor + term;
                        }
                    }
                    black_box(chains);
                });
            }
        });
    });
}

#[divan::bench(args = [Threads::One, Threads::All], sample_size = 1, sample_count = 20)]
fn multiply_add_one_lane(bencher: Bencher, threads: Threads) {
    let operations = threads.count() * STEPS * CHAINS * 2;
    bencher.counter(ItemsCount::new(operations)).bench_local(|| {
        scope(|s| {
            for _ in 0..threads.count() {
                s.spawn(|| {
                    let (factor, term) = (black_box(0.999f32), black_box(0.001f32));
                    let [mut a, mut b, mut c, mut d, mut e, mut f] = black_box([1f32; CHAINS / 2]);
                    let [mut g, mut h, mut i, mut j, mut k, mut l] = black_box([1f32; CHAINS / 2]);
                    for _ in 0..STEPS {
                        // Not an array, which would be put into wider registers.
                        (a, b, c, d) =
                            (a * factor + term, b * factor + term, c * factor + term, d * factor + term);
                        (e, f, g, h) =
                            (e * factor + term, f * factor + term, g * factor + term, h * factor + term);
                        (i, j, k, l) =
                            (i * factor + term, j * factor + term, k * factor + term, l * factor + term);
                    }
                    black_box(([a, b, c, d, e, f], [g, h, i, j, k, l]));
                });
            }
        });
    });
}
