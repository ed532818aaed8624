//! Chooses the triangles of a low-poly and tells how it went: `choose HIGH COUNT OUT.glb [LOW…]`; errors of other
//! low-polys are told too.
use parbake_files::{Limits, read_model, write_glb};
use parbake_image::display::{Curve, Display};
use parbake_model::{Material, Model};
use parbake_render::camera::Projection;
use parbake_render::interpretation::Interpretation;
use parbake_simplify::pictures::Pictures;
use parbake_simplify::polish::PolishOptions;
use parbake_simplify::surface::Surface;
use parbake_simplify::target::Target;
use parbake_simplify::*;
use parbake_views::high_poly::{Conventions, HighPoly};
use parbake_views::pool::{Rig, view_pool};
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let a: Vec<String> = std::env::args().collect();
    let var = |name: &str, own: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(own);
    let high = read_model(a[1].as_ref(), &Limits::default())?.model;
    let rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };
    let conventions = Conventions {
        interpretation: Interpretation { decode_srgb: true, trilinear: true, parallax: true },
        display: Display { gain: 1.0, curve: Curve::Srgb },
        rig,
        whole_material: None,
        max_distance: 0.1,
    };
    let prepared = HighPoly::new(&high, conventions)?;
    let (views, view_size) = (var("VIEWS", 64.0) as usize, var("SIZE", 128.0) as usize);
    let own = PolishOptions::default();
    let polish = PolishOptions {
        rounds: var("ROUNDS", own.rounds as f64) as usize,
        sweeps: var("SWEEPS", own.sweeps as f64) as usize,
        exchanged: var("EXCHANGED", own.exchanged),
    };
    let options = ChooseOptions { triangles: a[2].parse()?, room: 3, views, view_size, polish, seed: 0 };
    let begin = std::time::Instant::now();
    let chosen = choose_triangles(&prepared, None, &options, &());
    let seconds = begin.elapsed().as_secs_f64();
    let test = |b: [f32; 3]| -> Vec<Target> {
        view_pool(96, &rig, 77)
            .iter()
            .map(|v| Target::new(&prepared, None, v.camera, 192))
            .map(|mut t| {
                t.weigh(b);
                t
            })
            .collect()
    };
    let tests = [[0.33; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(test);
    let score = |mesh: &parbake_model::Mesh| {
        tests
            .iter()
            .map(|t| format!("{:.6} ", Pictures::new(t, Surface::new(mesh)).error()))
            .collect::<String>()
    };
    println!(
        "{:?} error {:.6} test {} triangles {} {seconds:.2} s",
        chosen.starts,
        chosen.error,
        score(&chosen.mesh),
        chosen.mesh.triangles.len()
    );
    for low in &a[4..] {
        let mut mesh = read_model(low.as_ref(), &Limits::default())?.model.mesh;
        prepared.frame.apply(&mut mesh);
        println!("{low} {} test {}", mesh.triangles.len(), score(&mesh));
    }
    let mut mesh = chosen.mesh;
    for p in &mut mesh.positions {
        *p = *p / prepared.frame.scale + prepared.frame.centre;
    }
    mesh.triangle_materials.fill(0);
    let model = Model { name: "low".into(), mesh, materials: vec![Material::default()], images: vec![] };
    write_glb(a[3].as_ref(), &model)?;
    Ok(())
}
