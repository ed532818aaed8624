//! What the paper's method does on pictures of a few triangles.

use glam::{DMat2, DVec2, Vec4, dvec2};
use parbake_atlas::Layout;
use parbake_image::FloatImage;
use parbake_uv::contact::{Border, Contact, ContactOptions};
use parbake_uv::descent::Region;
use parbake_uv::inversion;
use parbake_uv::least_squares_texture::ParameterizedSignal;
use parbake_uv::paper::texture_loss::TextureLoss;
use parbake_uv::paper::{Guide, PaperOptions, PaperResult, paper_method};
use parbake_uv::residual::residual;
use parbake_uv::signal::{Sample, Signal};
use parbake_uv::triangle_batches::TriangleBatches;

/// Cells along a side of the plane.
const CELLS: u32 = 4;

/// A plane whose picture has all its detail near one corner.
struct Plane {
    layout: Layout,
    signal: Signal,
    runs: TriangleBatches,
}

impl Plane {
    fn new() -> Self {
        let side = CELLS + 1;
        let at = |i: u32| (0.01 + 0.98 * f64::from(i) / f64::from(CELLS)) as f32;
        let points: Vec<DVec2> =
            (0..side * side).map(|p| dvec2(at(p % side).into(), at(p / side).into())).collect();
        let cells = (0..CELLS * CELLS).map(|c| c % CELLS + c / CELLS * side);
        let triangles: Vec<[u32; 3]> =
            cells.flat_map(|a| [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]]).collect();
        let mut samples = Vec::new();
        for (t, corners) in triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|i| points[i as usize]);
            for k in 0..36 {
                let (u, v) = ((f64::from(k % 6) + 0.5) / 6.0, (f64::from(k / 6) + 0.5) / 6.0);
                if u + v < 1.0 {
                    let p = a + (b - a) * u + (c - a) * v;
                    let wave =
                        if p.max_element() < 0.4 { (40.0 * p.x).sin() * (30.0 * p.y).cos() } else { p.x };
                    let target = Vec4::splat((0.5 + 0.4 * wave) as f32).with_w(0.0);
                    let barycentric = [u as f32, v as f32];
                    samples.push((t as u32, Sample { target, barycentric, weight: 1.0 }));
                }
            }
        }
        let signal = Signal::new(triangles.len(), &samples);
        let runs = TriangleBatches::new(&points, &triangles, &signal);
        let rest = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| points[i as usize]);
                DMat2::from_cols(b - a, c - a)
            })
            .collect();
        let charts = vec![0; triangles.len()];
        let point_of_vertex = (0..points.len() as u32).collect();
        Self { layout: Layout { points, triangles, rest, charts, point_of_vertex }, signal, runs }
    }

    fn mapped(&self) -> ParameterizedSignal<'_> {
        ParameterizedSignal {
            points: &self.layout.points,
            triangles: &self.layout.triangles,
            signal_scales: std::slice::from_ref(&self.signal),
            runs: &self.runs,
        }
    }

    fn bounds(&self) -> Bounds {
        let options = ContactOptions {
            texture_size: 8,
            gutter_texels: 0.0,
            activation_texels: 0.05,
            own_activation_texels: 0.05,
            border: Border::Margin { margin_texels: 0.0 },
        };
        Bounds { contact: Contact::new(&self.layout, &options), triangles: self.layout.triangles.clone() }
    }

    fn run(&self, options: &PaperOptions, bounds: &Bounds) -> PaperResult {
        let watch = |progress: &parbake_uv::paper::PaperProgress| {
            assert!(bounds.is_feasible(progress.points));
            true
        };
        let contact = Some(&bounds.contact);
        paper_method(&self.mapped(), &self.layout.rest, 8, bounds, contact, options, watch)
    }
}

struct Bounds {
    contact: Contact,
    triangles: Vec<[u32; 3]>,
}

impl Region for Bounds {
    fn free(&self) -> &[DVec2] {
        &self.contact.constraints().masks
    }

    fn max_step(&self, points: &[DVec2], direction: &[DVec2], limit: f64) -> f64 {
        let limit = inversion::max_step(&self.triangles, points, direction, limit);
        self.contact.max_step(points, direction, limit)
    }

    fn is_feasible(&self, points: &[DVec2]) -> bool {
        inversion::all_upright(&self.triangles, points) && self.contact.is_feasible(points)
    }
}

fn few_rounds() -> PaperOptions {
    PaperOptions {
        first_steps: 200,
        rounds: 40,
        last_steps: 200,
        distortion_weight: 1e-5,
        contact_texels: 0.05,
        scale: 0.25,
        ..PaperOptions::default()
    }
}

/// Protects the texture's gradient, against central differences of the error that the
/// texture coordinates are moved by.
#[test]
fn texture_gradient_is_the_derivative_of_the_error() {
    let plane = Plane::new();
    let mapped = plane.mapped();
    let mean_over = 3.0 * plane.signal.weight();
    let number = |i: usize| ((i * 2_654_435_761) % 1009) as f32 / 1009.0;
    let texels = (0..64).map(|i| Vec4::new(number(i + 1), number(i + 70), number(i + 140), 0.0)).collect();
    let texture = FloatImage::square(8, texels);
    let mut gradient = vec![Vec4::ONE; 64];
    TextureLoss::new(&mapped, 8, mean_over).gradient(&texture.texels, &mut gradient);
    let error = |t: &FloatImage<Vec4>| {
        residual(&mapped, t, &mut vec![DVec2::ZERO; mapped.points.len()])[0] / mean_over
    };
    for (texel, gradient) in gradient.iter().enumerate() {
        for (channel, got) in gradient.truncate().to_array().into_iter().map(f64::from).enumerate() {
            let h = 1.0 / 64.0;
            let (mut up, mut down) = (texture.clone(), texture.clone());
            up.texels[texel][channel] += h;
            down.texels[texel][channel] -= h;
            let slope = (error(&up) - error(&down)) / f64::from(2.0 * h);
            assert!((slope - got).abs() < 1e-6, "{texel} {channel}: {slope} {got}");
        }
    }
}

/// Protects the method: with the content-aware term and without, the error falls below
/// what the first layout allows, and every layout on the way is feasible.
#[test]
fn lowers_the_error_and_stays_feasible() {
    let plane = Plane::new();
    let bounds = plane.bounds();
    let still = plane.run(&PaperOptions { rounds: 0, ..few_rounds() }, &bounds);
    assert_eq!(still.points, plane.layout.points);
    for guide in [Guide::ContentAware, Guide::ImageLoss] {
        let result = plane.run(&PaperOptions { guide, ..few_rounds() }, &bounds);
        assert!(result.error < 0.97 * still.error, "{guide:?}: {} {}", result.error, still.error);
        assert!(bounds.is_feasible(&result.points));
        let inside = |t: &Vec4| t.min_element() >= 0.0 && t.max_element() <= 1.0;
        assert!(result.texture.texels.iter().all(inside));
    }
}

/// Protects the end at ε₁: a picture of one colour has nothing to move for.
#[test]
fn ends_when_nothing_changes() {
    let mut plane = Plane::new();
    plane.signal.samples.iter_mut().for_each(|s| s.target = Vec4::splat(0.5));
    let result = plane.run(&PaperOptions { scale: 1.0, ..few_rounds() }, &plane.bounds());
    assert!(result.rounds < 40 && result.error < 1e-9, "{} {}", result.rounds, result.error);
}

/// Protects that the watcher can end the alternation, and inputs without any sample.
#[test]
fn stops_when_asked_and_takes_empty_signals() {
    let plane = Plane::new();
    let bounds = plane.bounds();
    let options = few_rounds();
    let rest = &plane.layout.rest;
    let stopped = paper_method(&plane.mapped(), rest, 8, &bounds, None, &options, |p| p.round < 3);
    assert_eq!(stopped.rounds, 3);
    let signal = Signal::new(plane.layout.triangles.len(), &[]);
    let runs = TriangleBatches::new(&plane.layout.points, &plane.layout.triangles, &signal);
    let empty = ParameterizedSignal { signal_scales: &[signal], runs: &runs, ..plane.mapped() };
    let result = paper_method(&empty, rest, 0, &bounds, None, &options, |_| true);
    assert!(result.error == 0.0 && bounds.is_feasible(&result.points));
}

/// Protects the order of all sums.
#[test]
fn same_bytes_for_any_number_of_threads() {
    let plane = Plane::new();
    let bounds = plane.bounds();
    for guide in [Guide::ContentAware, Guide::ImageLoss] {
        let options = PaperOptions { rounds: 10, guide, ..few_rounds() };
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| plane.run(&options, &bounds))
        });
        assert_eq!(one, three);
    }
}
