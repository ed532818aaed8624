//! The check of the written texture coordinates on the page: its figures, and what is
//! wrong, in sentences.

use crate::page::text::{NOTHING, count, decimal, escape};
use parbake_atlas::UvCheck;
use std::fmt::Write;

/// The table, after the problems, if there are any.
pub fn uv_check(uv: &UvCheck) -> String {
    let mut out = String::new();
    let problems = uv.problems();
    if !problems.is_empty() {
        let items: Vec<String> = problems.iter().map(|p| escape(p)).collect();
        let _ = write!(out, r#"<ul class="notes"><li>{}</li></ul>"#, items.join("</li><li>"));
    }
    out += r#"<table class="texels"><tbody>"#;
    let o = &uv.orientations;
    let negative = o.flipped.count + o.mirrored_triangles;
    let mut row = |name: &str, value: String, meaning: &str| {
        let _ = write!(
            out,
            r#"<tr><th scope="row">{name}</th><td>{value}</td><td class="meaning">{meaning}</td></tr>"#
        );
    };
    row("charts", count(uv.charts), "connected pieces of the texture layout");
    row("flipped", count(negative), "triangles that lie mirrored in the texture");
    row(
        "degenerate",
        count(o.degenerate.count),
        "triangles that have an area in space but none in the texture",
    );
    row("outside", count(o.outside.count), "triangles that leave the texture");
    let overlaps = &uv.overlaps;
    let bound = if overlaps.complete { "" } else { "≥ " };
    row(
        "overlaps",
        format!("{bound}{}", count(overlaps.pairs)),
        &format!(
            "pairs of triangles that lie on each other, {bound}{} texels in all",
            decimal(overlaps.texels, 1)
        ),
    );
    let texels = |length: Option<f64>| length.map_or(NOTHING.into(), |length| decimal(length, 2));
    row(
        "gutter",
        texels(uv.gutter.as_ref().map(|gutter| gutter.texels)),
        "texels between the two charts that come nearest",
    );
    row("border", texels(uv.border), "texels between the triangles and the texture's border");
    row(
        "utilisation",
        format!("{} %", decimal(100.0 * uv.utilisation, 1)),
        "of the texture is covered by triangles",
    );
    if let Some(distortion) = &uv.distortion {
        row(
            "stretch",
            decimal(distortion.stretch_l2, 3),
            "L² texture stretch (Sander et al. 2001); 1 is best",
        );
        for (name, q, meaning) in [
            ("area scale", distortion.area_scale, "texels for a unit of surface, relative to the mean"),
            ("anisotropy", distortion.anisotropy, "longer to shorter side of what a texel shows"),
        ] {
            row(
                name,
                decimal(q.q50, 2),
                &format!(
                    "{meaning}: the median; 1 % of the surface lies below {}, 5 % below {}, 5 % above {}, 1 % above {}",
                    decimal(q.q1, 2),
                    decimal(q.q5, 2),
                    decimal(q.q95, 2),
                    decimal(q.q99, 2)
                ),
            );
        }
    }
    out + "</tbody></table>"
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake::check_mesh;
    use parbake_model::Mesh;
    use parbake_model::glam::{Vec2, Vec3};

    /// Protects the section for sound and for broken layouts.
    #[test]
    fn problems_stand_above_the_table() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
        let mut mesh = Mesh {
            positions: corners.iter().map(|&(x, y)| Vec3::new(x, y, 0.0)).collect(),
            uvs: corners.iter().map(|&(x, y)| Vec2::new(x, 1.0 - y)).collect(),
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            ..Mesh::default()
        };
        let html = uv_check(&check_mesh(&mesh, 64));
        assert!(html.starts_with("<table") && html.contains("<td>50.0 %</td>"), "{html}");
        mesh.uvs[1].x = 2.0;
        let html = uv_check(&check_mesh(&mesh, 64));
        assert!(html.contains("1 triangle leaves the texture (0).</li>"), "{html}");
        mesh.uvs.fill(Vec2::ZERO);
        assert!(!uv_check(&check_mesh(&mesh, 64)).contains("stretch"));
    }
}
