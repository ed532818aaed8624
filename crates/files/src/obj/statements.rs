//! The statements of an OBJ file: `v`, `vt`, `vn`, `f`, `usemtl`, `mtllib`.
//!
//! Follows the Wavefront "Object Files (.obj)" appendix, with what is common
//! since: colours after a position (`v x y z r g b`), any order of definitions
//! and uses. Lines, points, groups and smoothing groups are passed over.

use super::corner::{Corner, Forward, KINDS, NONE, corner};
use super::lex::{Lines, Words, number, text};
use super::polygon::{self, Plan};
use crate::context::Context;
use crate::{FileError, Place};
use parbake_model::glam::{DVec2, Vec3, Vec4};
use std::collections::HashMap;

/// So that the number of corners fits an index, whatever the limits say.
const MOST_TRIANGLES: usize = 1 << 30;

/// What the file says, before vertices are made of it.
#[derive(Default)]
pub(super) struct Statements {
    pub positions: Vec<Vec3>,
    /// As written, alpha 1 where there is none; all −1 where a vertex has no
    /// colour. Shorter than `positions` where the last vertices have none.
    pub colors: Vec<Vec4>,
    /// As written: v up. Doubles, so that turning v upside down loses nothing.
    pub texcoords: Vec<DVec2>,
    pub normals: Vec<Vec3>,
    pub triangles: Vec<[Corner; 3]>,
    pub triangle_materials: Vec<u32>,
    /// Names by which `triangle_materials` goes, in order of first use.
    pub material_names: Vec<String>,
    /// The words after each `mtllib`.
    pub libraries: Vec<Vec<u8>>,
    /// Faces of fewer than three corners.
    pub short_faces: usize,
    /// Whether there are free-form curves or surfaces.
    pub free_form: bool,
    /// Faces of more than three corners: the first of their triangles, and how many.
    polygons: Vec<(u32, u32)>,
}

/// Reads all statements of `bytes`.
pub(super) fn read(bytes: &[u8], context: &Context<'_>) -> Result<Statements, FileError> {
    let mut out = Statements::default();
    let mut forward: Forward = [(0, 0); 3];
    let mut corners: Vec<Corner> = Vec::new();
    let mut ids: HashMap<Vec<u8>, u32> = HashMap::new();
    let mut material: Option<u32> = None;
    let mut lines = Lines::new(bytes);
    while let Some((line, bytes)) = lines.next() {
        let mut words = Words::new(bytes);
        let Some(keyword) = words.next() else { continue };
        match keyword {
            b"v" => out.vertex(words, line, context)?,
            b"vt" => {
                let ([u, v], _) = numbers(words, 1, line, context)?;
                out.texcoords.push(DVec2::new(u, v));
            }
            b"vn" => {
                let (n, _) = numbers(words, 3, line, context)?;
                out.normals.push(Vec3::from_array(n));
            }
            b"f" | b"fo" => {
                corners.clear();
                for word in words {
                    let corner = corner(word, out.counts(), &mut forward, line);
                    corners.push(corner.map_err(|reason| context.invalid(Place::Line(line), reason))?);
                }
                let id = *material.get_or_insert_with(|| name_id(b"", &mut ids, &mut out.material_names));
                out.face(&corners, id, line, context)?;
            }
            b"usemtl" => material = Some(name_id(words.remainder(), &mut ids, &mut out.material_names)),
            b"mtllib" => out.libraries.push(words.remainder().to_vec()),
            b"curv" | b"curv2" | b"surf" => out.free_form = true,
            _ => {}
        }
    }
    out.check_forward(&forward, context)?;
    // Only now are all positions known.
    out.cut_polygons(context);
    Ok(out)
}

impl Statements {
    fn counts(&self) -> [usize; 3] {
        [self.positions.len(), self.texcoords.len(), self.normals.len()]
    }

    /// Holds what was used before its definition against all definitions.
    fn check_forward(&mut self, forward: &Forward, context: &Context<'_>) -> Result<(), FileError> {
        for (kind, (&(used, line), count)) in forward.iter().zip(self.counts()).enumerate() {
            if used as usize <= count {
                continue;
            }
            let name = KINDS[kind];
            if kind > 0 && count == 0 {
                // Some exporters number normals that they then leave out; the shape is whole.
                context
                    .warn(format!("faces use {name} numbers, but the file has no {name}; they are ignored"));
                self.triangles.as_flattened_mut().iter_mut().for_each(|corner| corner[kind] = NONE);
            } else {
                let reason = format!("the face uses {name} number {used}, but the file defines only {count}");
                return Err(context.invalid(Place::Line(line), reason));
            }
        }
        Ok(())
    }

    fn vertex(&mut self, words: Words<'_>, line: usize, context: &Context<'_>) -> Result<(), FileError> {
        let ([x, y, z, a, b, c, d], count) = numbers(words, 3, line, context)?;
        let position = Vec3::new(x, y, z);
        if !position.is_finite() {
            let reason = "the position is not finite (or too large for single precision)";
            return Err(context.invalid(Place::Line(line), reason));
        }
        let place = Place::Line(line);
        let found = self.positions.len() as u64 + 1;
        context.within(place, "positions", found, context.limits.max_vertices as u64)?;
        if count >= 6 {
            // Earlier vertices without a colour are marked so, to become white.
            self.colors.resize(self.positions.len(), Vec4::NEG_ONE);
            self.colors.push(Vec4::new(a, b, c, if count > 6 { d } else { 1.0 }));
        }
        self.positions.push(position);
        Ok(())
    }

    fn face(
        &mut self,
        corners: &[Corner],
        material: u32,
        line: usize,
        context: &Context<'_>,
    ) -> Result<(), FileError> {
        let [first, rest @ ..] = corners else {
            self.short_faces += 1;
            return Ok(());
        };
        self.short_faces += usize::from(rest.len() < 2);
        let found = self.triangles.len() + rest.len().saturating_sub(1);
        let limit = context.limits.max_triangles.min(MOST_TRIANGLES);
        context.within(Place::Line(line), "triangles", found as u64, limit as u64)?;
        if rest.len() > 2 {
            self.polygons.push((self.triangles.len() as u32, rest.len() as u32 - 1));
        }
        self.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        self.triangle_materials.resize(self.triangles.len(), material);
        Ok(())
    }

    /// Cuts those polygons anew that a fan does not cover.
    fn cut_polygons(&mut self, context: &Context<'_>) {
        let mut budget = polygon::BUDGET;
        let (mut corners, mut points) = (Vec::new(), Vec::new());
        for (first, count) in std::mem::take(&mut self.polygons) {
            let fan = &mut self.triangles[first as usize..][..count as usize];
            corners.clear();
            corners.extend([fan[0][0], fan[0][1]]);
            corners.extend(fan.iter().map(|triangle| triangle[2]));
            points.clear();
            points.extend(corners.iter().map(|c: &Corner| self.positions[c[0] as usize].as_dvec3()));
            match polygon::plan(&points, &mut budget) {
                Plan::Fan => {}
                Plan::Triangles(cuts) => {
                    for (triangle, cut) in fan.iter_mut().zip(cuts) {
                        *triangle = cut.map(|i| corners[i]);
                    }
                }
                Plan::TooCostly => {
                    context.warn("some faces have very many corners and may be filled wrongly")
                }
            }
        }
    }
}

fn name_id(name: &[u8], ids: &mut HashMap<Vec<u8>, u32>, names: &mut Vec<String>) -> u32 {
    if let Some(&id) = ids.get(name) {
        return id;
    }
    let id = names.len() as u32;
    ids.insert(name.to_vec(), id);
    names.push(text(name));
    id
}

/// Up to N numbers, at least `least`, the others 0; and how many there were.
#[inline]
fn numbers<const N: usize, T: std::str::FromStr + Default + Copy>(
    words: Words<'_>,
    least: usize,
    line: usize,
    context: &Context<'_>,
) -> Result<([T; N], usize), FileError> {
    let mut values = [T::default(); N];
    let mut count = 0;
    for (value, word) in values.iter_mut().zip(words) {
        *value = number(word)
            .ok_or_else(|| context.invalid(Place::Line(line), format!("{:?} is not a number", text(word))))?;
        count += 1;
    }
    if count < least {
        let reason = format!("{least} numbers are needed, but there are {count}");
        return Err(context.invalid(Place::Line(line), reason));
    }
    Ok((values, count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Textures;
    use crate::{Limits, NoResources};
    use std::path::Path;

    fn run(bytes: &[u8]) -> Result<Statements, String> {
        let limits = Limits { max_triangles: 5, ..Limits::default() };
        let context = Context::new(Path::new("a.obj"), &NoResources, &limits, Textures::Decode);
        read(bytes, &context).map_err(|e| e.to_string())
    }

    const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\n";

    fn with(rest: &str) -> Result<Statements, String> {
        run(format!("{CORNERS}{rest}").as_bytes())
    }

    /// Protects all forms of corners, and fans.
    #[test]
    fn faces_in_all_forms() {
        let n = NONE;
        assert_eq!(with("f 1 2 3").unwrap().triangles, [[[0, n, n], [1, n, n], [2, n, n]]]);
        assert_eq!(with("f -4/-1/-1 2/1 3//1").unwrap().triangles, [[[0, 0, 0], [1, 0, n], [2, n, 0]]]);
        assert_eq!(with("f 1// 2/1/ +3// #c").unwrap().triangles, [[[0, n, n], [1, 0, n], [2, n, n]]]);
        let quad = with("f 1 2 \\\n 3 4").unwrap();
        assert_eq!(
            quad.triangles.iter().map(|t| t.map(|c| c[0])).collect::<Vec<_>>(),
            [[0, 1, 2], [0, 2, 3]]
        );
        assert_eq!(with("f 1 2\nf\nl 1 2").unwrap().short_faces, 2);
        assert_eq!(run(b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 1").unwrap().triangles.len(), 1);
    }

    /// Protects the promise that errors name the line.
    #[test]
    fn errors_name_the_line() {
        for (text, expected) in [
            ("f 1 2 5", "line 7: the face uses v number 5, but the file defines only 4"),
            ("f 1 2 -5", "line 7: the face uses v number -5, but up to here the file defines only 4"),
            ("f 1 2 0", "counts from 1"),
            ("f 1/2 2/1 3/1", "line 7: the face uses vt number 2"),
            ("f 1//1 2//1 3//9", "line 7: the face uses vn number 9"),
            ("f 1 2 99999999999999999999", "not a face corner"),
            ("f 1 2 3/1/1/1", "not a face corner"),
            ("f 1 2 x", "\"x\" is not a face corner"),
            ("f 1 2 /1", "no position"),
            ("\nv 1 2", "line 8: 3 numbers are needed, but there are 2"),
            ("v 1 2 x", "\"x\" is not a number"),
            ("v 1 2 nan", "line 7: the position is not finite"),
            ("v 1 2 1e40", "line 7: the position is not finite"),
            ("f 1 2 3 4 1 2 3 4", "line 7: triangles: 6, and the limit is 5"),
        ] {
            let error = with(text).err().unwrap_or_default();
            assert!(error.starts_with("a.obj") && error.contains(expected), "{text}: {error}");
        }
    }

    /// Protects files whose exporter numbered normals but wrote none.
    #[test]
    fn normals_that_were_never_written_are_ignored() {
        let out = run(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//2 3//3").unwrap();
        assert_eq!(out.triangles, [[[0, NONE, NONE], [1, NONE, NONE], [2, NONE, NONE]]]);
    }

    /// Protects vertex colours that only some vertices have, and materials' order.
    #[test]
    fn colours_and_materials() {
        let out =
            run(b"v 0 0 0\nv 0 0 0 .1 .2 .3\nv 0 0 0 1\nusemtl b c\nf 1 2 3\nusemtl a\nusemtl b c\nf 1 2 3");
        let out = out.unwrap();
        assert_eq!(out.colors, [Vec4::NEG_ONE, Vec4::new(0.1, 0.2, 0.3, 1.0)]);
        assert_eq!(out.material_names, ["b c", "a"]);
        assert_eq!(out.triangle_materials, [0, 0]);
    }
}
