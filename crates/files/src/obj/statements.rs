//! The statements of an OBJ file: `v`, `vt`, `vn`, `f`, `usemtl`, `mtllib`.
//!
//! Follows the Wavefront "Object Files (.obj)" appendix, with what is common
//! since: colours after a position (`v x y z r g b`), any order of definitions
//! and uses. Polygons become fans around their first corner. Lines, points,
//! groups and smoothing groups are passed over.

use super::lex::{Lines, Words, number, text};
use crate::context::Context;
use crate::{FileError, Place};
use parbake_model::glam::{DVec2, Vec3, Vec4};
use std::collections::HashMap;

/// Stands for an index that a face does not give.
pub(super) const NONE: u32 = u32::MAX;

/// So that the number of corners fits an index, whatever the limits say.
const MOST_TRIANGLES: usize = 1 << 30;

/// Indices of position, texture coordinate and normal.
pub(super) type Corner = [u32; 3];

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
}

/// The highest use so far of something not yet defined, and its line.
type Forward = [(u32, usize); 3];

const KINDS: [&str; 3] = ["v", "vt", "vn"];

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
                out.face(&corners, id, context)?;
            }
            b"usemtl" => material = Some(name_id(words.remainder(), &mut ids, &mut out.material_names)),
            b"mtllib" => out.libraries.push(words.remainder().to_vec()),
            b"curv" | b"curv2" | b"surf" => out.free_form = true,
            _ => {}
        }
    }
    out.check_forward(&forward, context)?;
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
                let reason = format!("the face uses {name} number {used}, but there are only {count}");
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

    fn face(&mut self, corners: &[Corner], material: u32, context: &Context<'_>) -> Result<(), FileError> {
        let [first, rest @ ..] = corners else {
            self.short_faces += 1;
            return Ok(());
        };
        self.short_faces += usize::from(rest.len() < 2);
        let found = self.triangles.len() + rest.len().saturating_sub(1);
        let limit = context.limits.max_triangles.min(MOST_TRIANGLES);
        context.within(Place::File, "triangles", found as u64, limit as u64)?;
        self.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        self.triangle_materials.resize(self.triangles.len(), material);
        Ok(())
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

/// `position`, `position/texture`, `position//normal` or `position/texture/normal`.
#[inline]
fn corner(word: &[u8], counts: [usize; 3], forward: &mut Forward, line: usize) -> Result<Corner, String> {
    let mut corner = [NONE; 3];
    let mut rest = word;
    for kind in 0..3 {
        let (value, after) = index(rest).ok_or_else(|| format!("{:?} is not a face corner", text(word)))?;
        if let Some(value) = value {
            corner[kind] = resolve(value, counts[kind], KINDS[kind])?;
            // Most files define first; only what is used before its definition
            // has to wait for the end of the file.
            if corner[kind] as usize >= counts[kind] {
                forward[kind] = forward[kind].max((corner[kind] + 1, line));
            }
        } else if kind == 0 {
            return Err(format!("{:?} gives no position", text(word)));
        }
        match after {
            [] => return Ok(corner),
            [b'/', tail @ ..] if kind < 2 => rest = tail,
            _ => break,
        }
    }
    Err(format!("{:?} is not a face corner", text(word)))
}

/// A signed integer at the beginning, or nothing before a slash or the end; and
/// what follows it.
#[inline]
fn index(word: &[u8]) -> Option<(Option<i64>, &[u8])> {
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        [] | [b'/', ..] => return Some((None, word)),
        _ => (false, word),
    };
    let end = digits.iter().position(|b| !b.is_ascii_digit()).unwrap_or(digits.len());
    // Eighteen digits cannot overflow; what is longer is out of range anyway.
    if end == 0 || end > 18 {
        return None;
    }
    let value = digits[..end].iter().fold(0, |n, &d| n * 10 + i64::from(d - b'0'));
    Some((Some(if negative { -value } else { value }), &digits[end..]))
}

/// From OBJ's counting (from 1, or backwards from −1) to indices from 0.
#[inline]
fn resolve(value: i64, count: usize, kind: &str) -> Result<u32, String> {
    let index = match value {
        0 => return Err(format!("the face uses {kind} number 0, but OBJ counts from 1")),
        v if v < 0 => v + count as i64,
        v => v - 1,
    };
    // One below NONE, so that forward uses can be kept as index + 1.
    u32::try_from(index)
        .ok()
        .filter(|&i| i < NONE - 1)
        .ok_or_else(|| format!("the face uses {kind} number {value}, but there are {count} up to here"))
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
            ("f 1 2 5", "line 7: the face uses v number 5, but there are only 4"),
            ("f 1 2 -5", "line 7: the face uses v number -5, but there are 4 up to here"),
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
            ("f 1 2 3 4 1 2 3 4", "triangles: 6, and the limit is 5"),
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
