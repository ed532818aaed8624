// throw-away: error by pixel class
use parbake::*;
use parbake_mesh::{compute_tangents, ensure_normals};
use parbake_model::{Bounds, Placement};
use parbake_render::camera::*;
use parbake_render::display::*;
use parbake_render::scene::*;
use parbake_render::shade::Lambert;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let l = Limits::default();
    let high = read_model(a[1].as_ref(), &l).unwrap().model;
    let low = read_model(a[2].as_ref(), &l).unwrap().model;
    let f = Placement::unit_box(&Bounds::of(&high.mesh).unwrap()).unwrap();
    let sc = |m: &Model| {
        let mut mesh = m.mesh.clone();
        ensure_normals(&mut mesh);
        if mesh.tangents.is_empty() { compute_tangents(&mut mesh); }
        f.apply(&mut mesh);
        Scene::new(mesh, &m.materials, &m.images, Interpretation { decode_srgb: false, trilinear: true, parallax: true })
    };
    let (h, lo) = (sc(&high), sc(&low));
    let cut = std::fs::read("/tmp/cutout.bin").ok().map(|b| {
        let mut c = parbake_render::cutout::ShCutout::opaque(b[0] as usize, b[1] as usize);
        for (c, b) in c.coefficients.iter_mut().zip(b[2..].chunks(4)) { *c = f32::from_le_bytes(b.try_into().unwrap()); }
        c
    });
    let render = |c: &Camera, size: usize| -> Picture {
        use parbake_render::raster::*;
        let Some(cut) = &cut else { return lo.render(&Lambert, c, size, 2); };
        let screen = lo.on_screen(c, size * 2);
        let mut seen = Visibility::default();
        let mesh = lo.mesh();
        parbake_render::cutout::rasterise_cut(&screen, size * 2, (0.0, 0.0), &mut seen, |t, at| {
            let b = parbake_render::interpolate::barycentrics(&screen.triangles[t], at.0, at.1).weights;
            let k = mesh.triangles[t].map(|i| i as usize);
            let p = parbake_render::interpolate::interpolate(k.map(|i| mesh.positions[i]), b);
            let uv = parbake_render::interpolate::interpolate(k.map(|i| mesh.uvs[i]), b);
            cut.opacity(uv, c.view_direction(p)) >= 0.0
        });
        let mut rgba = vec![[0.0f32; 4]; size * size];
        for y in 0..size * 2 { for x in 0..size * 2 {
            let t = seen.triangle[y * size * 2 + x];
            if t == NOTHING { continue; }
            let l = lo.shade(&Lambert, c, &screen, t as usize, (x as f64 + 0.5, y as f64 + 0.5), 1.0);
            let o = &mut rgba[y / 2 * size + x / 2];
            for k in 0..3 { o[k] += l[k] * 0.25; }
            o[3] += 0.25;
        }}
        Picture { size, rgba }
    };
    let size = 384;
    for (name, bg) in [("black", [0.0f32; 3]), ("grey", [0.5; 3]), ("white", [1.0; 3])] {
        let mut e = [0f64; 4];
        let mut n = [0f64; 4];
        let mut psnr = 0.0;
        for (v, d) in fibonacci_sphere(24, 0.0).into_iter().enumerate() {
            let c = Camera::towards_origin(d, 3.5, Projection::Perspective(0.4));
            let p = h.render(&Lambert, &c, size, 2);
            let q = render(&c, size);
            let show = |p: &Picture| -> Vec<[f32; 3]> { p.rgba.iter().map(|x| std::array::from_fn(|k| encode_srgb(x[k] * 1.59 + (1.0 - x[3]) * bg[k]).clamp(0.0, 1.0))).collect() };
            let (s, t) = (show(&p), show(&q));
            let mut all = 0.0;
            for i in 0..size * size {
                let (ha, la) = (p.rgba[i][3], q.rgba[i][3]);
                let class = if ha == 1.0 && la == 1.0 { 0 } else if la > ha { 1 } else if ha > la { 2 } else { 3 };
                let err: f64 = (0..3).map(|k| ((s[i][k] - t[i][k]) as f64).powi(2)).sum::<f64>() / 3.0;
                e[class] += err; n[class] += 1.0; all += err;
            }
            psnr += -10.0 * (all / (size * size) as f64).log10() / 24.0;
            if name == "grey" && a.len() > 3 && [1usize, 6, 11, 16].contains(&v) {
                let mut im = vec![0u8; size * 3 * size * 3];
                for y in 0..size { for x in 0..size { for k in 0..3 {
                    let i = y * size + x;
                    im[(y * size * 3 + x) * 3 + k] = (s[i][k] * 255.0) as u8;
                    im[(y * size * 3 + x + size) * 3 + k] = (t[i][k] * 255.0) as u8;
                    im[(y * size * 3 + x + 2 * size) * 3 + k] = (128.0 + (t[i][k] - s[i][k]) * 255.0).clamp(0.0, 255.0) as u8;
                }}}
                std::fs::write(format!("{}_{v}.ppm", a[3]), [format!("P6 {} {} 255\n", size * 3, size).into_bytes(), im].concat()).unwrap();
            }
        }
        let tot: f64 = e.iter().sum();
        println!("{name} {psnr:.2} interior {:.0}% overhang {:.0}% underhang {:.0}%  (pixels {:.3} {:.3} {:.3})", 100.0 * e[0] / tot, 100.0 * e[1] / tot, 100.0 * e[2] / tot, n[0] / n[3], n[1] / n[3], n[2] / n[3]);
    }
}
