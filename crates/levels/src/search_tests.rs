//! The search against made-up models whose best file is known.

use super::*;

/// A model whose errors follow a law.
struct Fake {
    /// Error of a bake with one triangle and no error of texels, and the power with which it falls.
    triangles: (f64, f64),
    /// Error of a map of one texel; it falls with the square of the side.
    texels: [f64; 2],
    /// What no file gets below.
    floor: f64,
    /// Decibels by which measurements vary.
    noise: f64,
    /// Triangles come in such numbers.
    multiple: usize,
    /// Bytes of a file without triangles and maps.
    fixed: usize,
}

impl Fake {
    fn noise(&self, seed: usize) -> f64 {
        self.noise * ((seed as f64 * 12.9898).sin() * 43758.5453).fract()
    }

    fn error(&self, triangles: usize, sizes: &[usize]) -> f64 {
        let (first, fall) = self.triangles;
        let of_map = |(k, &size): (usize, &usize)| self.texels[k] / (size.max(1) as f64).powi(2);
        let exact = self.floor
            + first * (triangles as f64).powf(-fall)
            + sizes.iter().enumerate().map(of_map).sum::<f64>();
        let seed = triangles * 31 + sizes.iter().sum::<usize>();
        exact * 10f64.powf(self.noise(seed) / 10.0)
    }

    fn bytes(&self, triangles: usize, sizes: &[usize]) -> u64 {
        (self.fixed + 30 * triangles + sizes.iter().map(|size| 2 * size * size).sum::<usize>()) as u64
    }

    /// Runs the search; returns it.
    fn run(&self, target: f64, most: Plan) -> Search {
        let mut search = Search::new(target, Plan { triangles: 500, texture_size: 256 }, 4, most);
        let mut known = Vec::new();
        while let Some(asked @ Plan { triangles, texture_size }) = search.next() {
            assert!(triangles <= most.triangles && texture_size <= most.texture_size);
            let is_known = |(came, size): &(std::ops::RangeInclusive<usize>, usize)| {
                *size == texture_size && came.contains(&triangles)
            };
            assert!(!known.iter().any(is_known), "{triangles} triangles, {texture_size}² among {known:?}");
            let triangles = (triangles - triangles % self.multiple).max(4);
            known.push((triangles..=asked.triangles, texture_size));
            let sizes = [texture_size, texture_size / 2, texture_size / 4, 0];
            let whole = self.error(triangles, &[texture_size; 2]);
            let steps = |map: usize| -> Vec<Step> {
                let step = |&size: &usize| {
                    let mut own = [texture_size; 2];
                    own[map] = size;
                    let error = self.error(triangles, &own) - whole;
                    Step { size, bytes: 2 * (size * size) as u64, error }
                };
                sizes.iter().map(step).collect()
            };
            let baking = Baking {
                asked,
                plan: Plan { triangles, texture_size },
                mesh_bytes: self.bytes(triangles, &[]),
                error: whole,
                maps: vec![steps(0), steps(1)],
            };
            let measured = baking.measured(target, |choice| {
                let own: Vec<usize> = choice.iter().map(|&step| sizes[step]).collect();
                Ok::<_, ()>((self.bytes(triangles, &own), -10.0 * self.error(triangles, &own).log10()))
            });
            search.note(baking, measured.unwrap());
        }
        assert!((1..=MOST_BAKES).contains(&search.bakes()));
        search
    }

    /// The fewest bytes of all.
    fn least_bytes(&self, target: f64, most: usize) -> u64 {
        let sizes = [0, 16, 32, 64, 128, 256, 512];
        let pairs = sizes.iter().flat_map(|&a| sizes.iter().map(move |&b| [a, b]));
        let files = pairs.flat_map(|pair| (4..most).map(move |triangles| (triangles, pair)));
        let reaching = files.filter(|(triangles, pair)| self.error(*triangles, pair) <= error_of(target));
        reaching.map(|(triangles, pair)| self.bytes(triangles, &pair)).min().unwrap()
    }
}

const MOST: Plan = Plan { triangles: 20_000, texture_size: 1024 };

/// Protects the promise of `--target-psnr`: the file reaches the target, is at most half a decibel above it, and
/// hardly larger than the smallest there is.
#[test]
fn the_smallest_file_is_found() {
    for (target, texels) in [(30.0, [4.0, 1.0]), (34.0, [0.5, 8.0]), (40.0, [1.0, 0.01]), (45.0, [0.2, 0.1])]
    {
        // Skeletons and animations take bytes whatever the triangles.
        for fixed in [400, 60_000] {
            let fake = Fake { triangles: (1.0, 1.3), texels, floor: 0.0, noise: 0.0, multiple: 1, fixed };
            let search = fake.run(target, MOST);
            let best = &search.outcomes[search.best().unwrap()];
            assert_eq!(search.verdict(false), Verdict::Reached, "{target}: {best:?}");
            let above = (best.bytes as usize - fixed) as f64
                / (fake.least_bytes(target, 20_000) as usize - fixed) as f64;
            assert!(above <= 1.12, "{target}: {best:?}, {above} times as many bytes as are enough");
        }
    }
}

/// Protects time: few triangles whose error falls steeply do not send the search through all sizes.
#[test]
fn few_bakes_are_enough() {
    let all =
        [(1e3, 2.4, [0.2, 0.01]), (1e2, 2.0, [1.0, 0.3]), (0.3, 1.0, [0.1, 2.0]), (30.0, 1.8, [0.02, 0.02])];
    let bakes = all.map(|(first, fall, texels)| {
        let fake = Fake { triangles: (first, fall), texels, floor: 0.0, noise: 0.1, multiple: 1, fixed: 400 };
        let search = fake.run(34.0, MOST);
        assert_eq!(search.verdict(false), Verdict::Reached);
        search.bakes()
    });
    assert!(bakes.iter().sum::<usize>() <= 5 * bakes.len(), "{bakes:?}");
}

/// Protects the bound on bakes and the target itself where measurements are not smooth.
#[test]
fn noise_does_not_mislead() {
    for target in [31.0, 35.0, 41.0] {
        let fake = Fake {
            triangles: (3.0, 1.6),
            texels: [2.0, 0.4],
            floor: 0.0,
            noise: 0.3,
            multiple: 1,
            fixed: 400,
        };
        let search = fake.run(target, MOST);
        let best = &search.outcomes[search.best().unwrap()];
        assert!(best.psnr >= target && best.psnr <= target + WINDOW, "{target}: {best:?}");
    }
}

/// Protects time where triangles come in steps, as on closed surfaces: what is known to come out as before is not
/// baked again ([`Fake::run`] looks), whether the target is reached or not.
#[test]
fn nothing_is_baked_twice() {
    for (multiple, floor, target) in [(2, 0.0, 32.0), (12, 0.0, 32.0), (12, 1e-3, 35.0), (24, 0.0, 26.0)] {
        let most = Plan { triangles: 100, texture_size: 64 };
        let fake =
            Fake { triangles: (0.1, 1.3), texels: [0.1, 0.05], floor, noise: 0.0, multiple, fixed: 400 };
        fake.run(target, most);
    }
}

/// Protects honest endings: a target that nothing reaches is told after all triangles and all texels were tried, one
/// that everything reaches with the smallest file.
#[test]
fn what_cannot_be_is_told() {
    let most = Plan { triangles: 2000, texture_size: 512 };
    let never =
        Fake { triangles: (1.0, 1.3), texels: [1.0, 1.0], floor: 1e-3, noise: 0.0, multiple: 1, fixed: 400 };
    let search = never.run(35.0, most);
    assert_eq!(search.verdict(false), Verdict::Missed);
    assert!(search.bakings.iter().any(|baking| baking.plan == most), "{:?}", search.bakings);
    assert!(search.outcomes[search.best().unwrap()].psnr > 29.0);
    let always = Fake {
        triangles: (1e-6, 0.5),
        texels: [1e-6, 1e-6],
        floor: 0.0,
        noise: 0.0,
        multiple: 1,
        fixed: 400,
    };
    let search = always.run(30.0, most);
    let best = &search.outcomes[search.best().unwrap()];
    assert_eq!(search.verdict(false), Verdict::Above);
    assert_eq!((search.bakings[best.bake].plan.triangles, &best.choice), (4, &vec![3, 3]));
}

/// Protects who pressed Ctrl-C before anything reached the target: that is not said to be out of reach.
#[test]
fn a_search_that_was_stopped_says_so() {
    let search = Search::new(30.0, Plan { triangles: 9, texture_size: 64 }, 4, MOST);
    assert_eq!((search.verdict(true), search.best()), (Verdict::Stopped, None));
}
