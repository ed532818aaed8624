//! Several textures in one, without a new layout: rectangles of them are moved and scaled, and nothing is turned.
//!
//! ```text
//! charts of each texture ─ boxes, by whole tiles into one ─ rectangles with what lies around ─ packed (MaxRects, `crunch`)
//! ```
//!
//! What artists drew stays as they drew it: where a texture keeps its scale, its texels are the same numbers, and where
//! it is halved, those of its next mip level. Rectangles that would cover fewer texels together become one. All are scaled by one
//! factor more, where they fit into half of the texels by that.
//!
//! Contract: a rectangle holds its charts and two texels more on each side; rectangles do not overlap, and begin and end at
//! multiples of four texels. Deterministic.

use crunch::{Item, Packer, Rect, Rotation};
use glam::{DVec2, dvec2};
use parbake_mesh::union_find::UnionFind;
use parbake_model::Wrap;
use parbake_model::glam::Vec2;
use std::collections::HashMap;

/// Texels of a texture around its charts that come along.
const AROUND: f64 = 2.0;
/// Rectangles begin and end at multiples of so many texels, so that halved maps begin and end at texels, too.
const STEP: i64 = 4;
/// Texels along a side of the rectangle of a source without textures.
const PLAIN: i64 = 8;
/// The least factor by which all rectangles are scaled for a smaller texture.
const LEAST_FACTOR: f64 = 0.75;
/// The least factor where no texture may be larger.
const SMALLEST_FACTOR: f64 = 1.0 / 64.0;
/// Halvings of the interval in which the greatest factor lies.
const BISECTIONS: usize = 8;
/// Charts of a source from which on all of them have one rectangle.
const MOST_CHARTS: usize = 512;

/// What one texture is read by, or several of the same size at the same coordinates.
pub struct Source {
    /// Corners of the triangles that show it.
    pub triangles: Vec<[u32; 3]>,
    /// Texels in the common texture for each unit of its coordinates, before they are scaled to fit; none where there is
    /// no texture, but one value all over.
    pub texels: Option<DVec2>,
    /// What lies outside of [0, 1)².
    pub wrap: [Wrap; 2],
}

/// A rectangle of a source and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Which source it shows.
    pub source: usize,
    /// The part of the source's texture, low and high corner, in its coordinates; none where it has no texture.
    pub shows: Option<[DVec2; 2]>,
    /// Its low corner in the common texture, in texels.
    pub place: [usize; 2],
    /// Texels along u and v.
    pub size: [usize; 2],
}

/// The common texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    /// Texels along u and v, each a power of two.
    pub size: [usize; 2],
    /// Its rectangles.
    pub blocks: Vec<Block>,
    /// Texture coordinates of all vertices in it; (0, 0) for those that no source uses.
    pub uvs: Vec<Vec2>,
}

/// A chart: its vertices, their box, and the whole tiles by which it moves.
struct Chart {
    vertices: Vec<u32>,
    bounds: [DVec2; 2],
    tiles: DVec2,
}

/// A rectangle of texels of a source, and the charts in it.
#[derive(Clone)]
struct Part {
    low: [i64; 2],
    high: [i64; 2],
    charts: Vec<usize>,
}

impl Part {
    /// The corners of the rectangle around both.
    fn around(&self, other: &Self) -> [[i64; 2]; 2] {
        let low = [0, 1].map(|k| self.low[k].min(other.low[k]));
        [low, [0, 1].map(|k| self.high[k].max(other.high[k]))]
    }

    fn with(&self, other: &Self) -> Self {
        let [low, high] = self.around(other);
        Self { low, high, charts: [&self.charts[..], &other.charts].concat() }
    }

    fn size(&self) -> [i64; 2] {
        [0, 1].map(|k| self.high[k] - self.low[k])
    }

    fn area(&self) -> i64 {
        self.size().iter().product()
    }

    /// Whether one rectangle around both takes no more texels than two.
    fn is_better_with(&self, other: &Self) -> bool {
        let [low, high] = self.around(other);
        (high[0] - low[0]) * (high[1] - low[1]) <= self.area() + other.area()
    }
}

/// Puts sources into the smallest texture of at most `most_texels` texels and `most_side` texels along a side that holds
/// them, all scaled by one factor where that has to be. `uvs` are the V vertices' coordinates as their source reads them. `aspect`
/// is how many texels along u the texture has for each along v, a power of two; where none is given it is 1 or 2.
///
/// None where a vertex belongs to two sources, coordinates are not finite, or no such texture holds all.
pub fn blocks(
    sources: &[Source],
    uvs: &[Vec2],
    most_side: usize,
    most_texels: usize,
    aspect: Option<f64>,
) -> Option<Blocks> {
    let mut owner = vec![usize::MAX; uvs.len()];
    for (index, source) in sources.iter().enumerate() {
        for v in source.triangles.as_flattened() {
            let own = &mut owner[*v as usize];
            if (*own != usize::MAX && *own != index) || !uvs[*v as usize].is_finite() {
                return None;
            }
            *own = index;
        }
    }
    let charts: Vec<Vec<Chart>> = sources.iter().map(|source| charts_of(source, uvs)).collect();
    let at = |factor: f64, size: [usize; 2]| packed(sources, &charts, factor, size);
    let sizes = sizes(most_side, most_texels, aspect);
    let (last, _) = sizes.split_last()?;
    for &size in &sizes {
        let least = if size == *last { SMALLEST_FACTOR } else { LEAST_FACTOR };
        let found = at(1.0, size).map(|parts| (1.0, parts)).or_else(|| {
            let mut best = (least, at(least, size)?);
            let (mut low, mut high) = (least, 1.0);
            for _ in 0..BISECTIONS {
                let middle = f64::sqrt(low * high);
                match at(middle, size) {
                    Some(parts) => (low, best) = (middle, (middle, parts)),
                    None => high = middle,
                }
            }
            Some(best)
        });
        if let Some((factor, parts)) = found {
            return Some(placed(sources, &charts, uvs, factor, size, &parts));
        }
    }
    None
}

/// Sizes from small to large: squares, and rectangles twice as wide as high, or those of one aspect.
fn sizes(most_side: usize, most_texels: usize, aspect: Option<f64>) -> Vec<[usize; 2]> {
    let heights = (3..usize::BITS - 1).map(|k| 1usize << k).take_while(|&side| side <= most_side);
    let aspects = aspect.map_or(vec![1.0, 2.0], |aspect| vec![aspect]);
    let all = heights.flat_map(|h| aspects.iter().map(move |aspect| [(aspect * h as f64) as usize, h]));
    let fits = |w: usize, h: usize| w.is_power_of_two() && w >= 8 && w <= most_side && w * h <= most_texels;
    all.filter(|[w, h]| fits(*w, *h)).collect()
}

/// Charts: triangles that share a vertex, or coordinates, are of one.
fn charts_of(source: &Source, uvs: &[Vec2]) -> Vec<Chart> {
    let mut first_at: HashMap<[u32; 2], u32> = HashMap::new();
    let mut sets = UnionFind::new(uvs.len());
    for triangle in &source.triangles {
        for &v in triangle {
            let same = *first_at.entry(uvs[v as usize].to_array().map(f32::to_bits)).or_insert(v);
            sets.union(same, v);
            sets.union(triangle[0], v);
        }
    }
    let mut vertices = source.triangles.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let mut charts: Vec<Chart> = Vec::new();
    let mut chart_of: HashMap<u32, usize> = HashMap::new();
    for v in vertices {
        let place = *chart_of.entry(sets.find(v)).or_insert_with(|| {
            charts.push(Chart { vertices: Vec::new(), bounds: [DVec2::MAX, DVec2::MIN], tiles: DVec2::ZERO });
            charts.len() - 1
        });
        let chart = &mut charts[place];
        let uv = uvs[v as usize].as_dvec2();
        chart.vertices.push(v);
        chart.bounds = [chart.bounds[0].min(uv), chart.bounds[1].max(uv)];
    }
    for chart in &mut charts {
        let middle = 0.5 * (chart.bounds[0] + chart.bounds[1]);
        let tiles = [0, 1].map(|k| match source.wrap[k] {
            Wrap::Repeat => middle[k].floor(),
            // Every second copy is the same.
            Wrap::Mirror => 2.0 * (0.5 * middle[k]).floor(),
            Wrap::Clamp => 0.0,
        });
        chart.tiles = DVec2::from(tiles);
        chart.bounds = chart.bounds.map(|corner| corner - chart.tiles);
    }
    charts
}

/// The rectangles of a source whose texture is scaled by a factor.
fn parts_of(source: &Source, charts: &[Chart], factor: f64) -> Option<Vec<Part>> {
    let Some(texels) = source.texels.map(|texels| texels * factor) else {
        return Some(vec![Part { low: [0; 2], high: [PLAIN; 2], charts: (0..charts.len()).collect() }]);
    };
    let step = STEP as f64;
    let part = |(index, chart): (usize, &Chart)| {
        let low = ((chart.bounds[0] * texels - AROUND) / step).floor();
        let high = ((chart.bounds[1] * texels + AROUND) / step).ceil();
        let is_sane = low.abs().max(high.abs()).max_element() < 1e9;
        let whole = |corner: DVec2| corner.to_array().map(|x| x as i64 * STEP);
        is_sane.then(|| Part { low: whole(low), high: whole(high), charts: vec![index] })
    };
    let mut parts: Vec<Part> = charts.iter().enumerate().map(part).collect::<Option<_>>()?;
    if parts.len() > MOST_CHARTS {
        return Some(parts.into_iter().reduce(|a, b| a.with(&b)).into_iter().collect());
    }
    // All that one rectangle is better for are united, until there are none.
    let mut index = 0;
    while index < parts.len() {
        let is_joined = |other: &usize| *other != index && parts[index].is_better_with(&parts[*other]);
        match (0..parts.len()).find(is_joined) {
            Some(other) => {
                parts[index] = parts[index].with(&parts[other]);
                parts.remove(other);
                // Those before this one were compared with the smaller rectangle.
                index = 0;
            }
            None => index += 1,
        }
    }
    Some(parts)
}

type Placed = (usize, Part, [usize; 2]);

/// All rectangles with their places, where they fit.
fn packed(sources: &[Source], charts: &[Vec<Chart>], factor: f64, size: [usize; 2]) -> Option<Vec<Placed>> {
    let mut items = Vec::new();
    for (index, (source, charts)) in sources.iter().zip(charts).enumerate() {
        for part in parts_of(source, charts, factor)? {
            let [w, h] = part.size().map(|side| (side / STEP) as usize);
            items.push(Item::new((index, part), w, h, Rotation::None));
        }
    }
    let units = size.map(|side| side / STEP as usize);
    let area: usize = items.iter().map(|item| item.w.saturating_mul(item.h)).fold(0, usize::saturating_add);
    if area > units[0] * units[1] {
        return None;
    }
    let packed = Packer::with_items(items).pack(Rect::of_size(units[0], units[1])).ok()?;
    let place = |rect: Rect| [rect.x * STEP as usize, rect.y * STEP as usize];
    Some(packed.into_iter().map(|item| (item.data.0, item.data.1, place(item.rect))).collect())
}

fn placed(
    sources: &[Source],
    charts: &[Vec<Chart>],
    uvs: &[Vec2],
    factor: f64,
    size: [usize; 2],
    parts: &[Placed],
) -> Blocks {
    let mut out = Blocks { size, blocks: Vec::new(), uvs: vec![Vec2::ZERO; uvs.len()] };
    let whole = dvec2(size[0] as f64, size[1] as f64);
    for (source, part, place) in parts {
        let texels = sources[*source].texels.map(|texels| texels * factor);
        let corner = dvec2(place[0] as f64, place[1] as f64);
        let [low, high] = [part.low, part.high].map(|[x, y]| dvec2(x as f64, y as f64));
        for chart in part.charts.iter().map(|&index| &charts[*source][index]) {
            for &v in &chart.vertices {
                let inside = match texels {
                    Some(texels) => (uvs[v as usize].as_dvec2() - chart.tiles) * texels - low,
                    None => 0.5 * (high - low),
                };
                out.uvs[v as usize] = ((corner + inside) / whole).as_vec2();
            }
        }
        out.blocks.push(Block {
            source: *source,
            shows: texels.map(|texels| [low / texels, high / texels]),
            place: *place,
            size: part.size().map(|side| side as usize),
        });
    }
    out
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parbake_model::glam::vec2;
    use proptest::prelude::*;

    /// A square of two triangles whose vertices begin at `first`.
    fn square(first: u32) -> Vec<[u32; 3]> {
        vec![[first, first + 1, first + 2], [first, first + 2, first + 3]]
    }

    fn corners(low: Vec2, high: Vec2) -> [Vec2; 4] {
        [low, vec2(high.x, low.y), high, vec2(low.x, high.y)]
    }

    fn source(first: u32, texels: f64) -> Source {
        Source { triangles: square(first), texels: Some(DVec2::splat(texels)), wrap: [Wrap::Repeat; 2] }
    }

    /// Protects drawings: where a texture keeps its scale, charts move by whole texels, also those in other tiles.
    #[test]
    fn texels_stay_texels() {
        let uvs = [
            corners(vec2(0.1875, 0.1875), vec2(0.8125, 0.8125)),
            corners(vec2(3.1875, -0.8125), vec2(3.25, -0.75)),
        ]
        .concat();
        let plain = Source { texels: None, ..source(4, 0.0) };
        let out = blocks(&[source(0, 64.0), source(4, 64.0)], &uvs, 1024, usize::MAX, None).unwrap();
        assert_eq!(out.size, [64, 64]);
        let texels = |uv: Vec2| uv * 64.0;
        for (first, block) in [0usize, 4].into_iter().zip(0..2usize) {
            let own = out.blocks.iter().find(|b| b.source == block).unwrap();
            let [low, high] = own.shows.unwrap();
            let size = dvec2(own.size[0] as f64, own.size[1] as f64);
            assert_eq!((high - low) * 64.0, size);
            assert_eq!((low * 64.0).fract(), DVec2::ZERO);
            let moved = texels(out.uvs[first]) - uvs[first] * 64.0;
            let all = out.uvs.iter().zip(&uvs).skip(first).take(4);
            assert!(all.map(|(now, before)| texels(*now) - *before * 64.0).all(|own| own == moved));
            assert_eq!(moved.fract(), Vec2::ZERO);
        }
        let out = blocks(&[source(0, 64.0), plain], &uvs, 1024, usize::MAX, None).unwrap();
        let block = out.blocks.iter().find(|b| b.source == 1).unwrap();
        assert_eq!((block.shows, block.size), (None, [8, 8]));
        let middle = (vec2(block.place[0] as f32, block.place[1] as f32) + 4.0)
            / vec2(out.size[0] as f32, out.size[1] as f32);
        assert!(out.uvs[4..].iter().all(|uv| *uv == middle));
    }

    /// Protects small files: a whole texture and a few values do not take twice its texels, but a little of its scale.
    #[test]
    fn a_little_scale_is_given_for_half_of_the_texels() {
        let uvs = [corners(Vec2::ZERO, Vec2::ONE), corners(Vec2::ZERO, Vec2::ONE)].concat();
        let plain = Source { texels: None, ..source(4, 0.0) };
        let out = blocks(&[source(0, 512.0), plain], &uvs, 1024, usize::MAX, None).unwrap();
        assert_eq!(out.size, [512, 512]);
        let share = out.uvs[2].x - out.uvs[0].x;
        assert!((0.9..1.0).contains(&share), "{share}");
        // With too few texels all the same.
        let out = blocks(&[source(0, 512.0), source(4, 512.0)], &uvs, 1024, 128 * 128, None).unwrap();
        assert_eq!(out.size, [128, 128]);
    }

    /// Protects relief where viewers make up tangents: a texture of a given aspect scales all coordinates alike.
    #[test]
    fn an_aspect_is_kept() {
        let uvs = [corners(Vec2::ZERO, Vec2::ONE), corners(Vec2::ZERO, Vec2::ONE)].concat();
        let sources = [source(0, 64.0), source(4, 64.0)];
        let of = |aspect| blocks(&sources, &uvs, 1024, usize::MAX, aspect).unwrap().size;
        assert_eq!((of(None), of(Some(1.0)), of(Some(0.5))), ([128, 64], [128, 128], [64, 128]));
        assert!(blocks(&sources, &uvs, 1024, usize::MAX, Some(1.0 / 256.0)).is_none());
    }

    /// Protects from textures that no vertex can read.
    #[test]
    fn what_cannot_be_moved_is_refused() {
        let uvs = corners(Vec2::ZERO, Vec2::ONE);
        assert!(blocks(&[source(0, 64.0), source(0, 64.0)], &uvs, 1024, usize::MAX, None).is_none());
        let mut broken = uvs;
        broken[2].x = f32::NAN;
        assert!(blocks(&[source(0, 64.0)], &broken, 1024, usize::MAX, None).is_none());
        assert!(blocks(&[source(0, 64.0)], &uvs, 4, usize::MAX, None).is_none());
    }

    proptest! {
        /// Protects every texture: blocks lie within it and apart, and each vertex within a block of its own source with
        /// texels around it.
        #[test]
        fn blocks_hold_their_charts(boxes in prop::collection::vec((0.0f32..3.0, -2.0f32..1.0, 0.01f32..2.0, 0.01f32..1.0, 0usize..3), 1..12)) {
            let uvs: Vec<Vec2> = boxes.iter().flat_map(|&(x, y, w, h, _)| corners(vec2(x, y), vec2(x + w, y + h))).collect();
            let of = |k: usize| Source {
                triangles: (0..boxes.len()).filter(|&b| boxes[b].4 == k).flat_map(|b| square(4 * b as u32)).collect(),
                texels: [Some(dvec2(256.0, 128.0)), Some(DVec2::splat(100.0)), None][k],
                wrap: [[Wrap::Repeat; 2], [Wrap::Mirror, Wrap::Clamp], [Wrap::Repeat; 2]][k],
            };
            let sources: Vec<Source> = (0..3).map(of).collect();
            let out = blocks(&sources, &uvs, 1024, 1 << 18, None).unwrap();
            prop_assert!(out.size[0] * out.size[1] <= 1 << 18);
            for (i, a) in out.blocks.iter().enumerate() {
                prop_assert!((0..2).all(|k| a.place[k] + a.size[k] <= out.size[k]));
                for b in &out.blocks[i + 1..] {
                    prop_assert!((0..2).any(|k| a.place[k] + a.size[k] <= b.place[k] || b.place[k] + b.size[k] <= a.place[k]));
                }
            }
            for (b, uv) in out.uvs.chunks(4).enumerate() {
                let texels: Vec<Vec2> = uv.iter().map(|uv| *uv * vec2(out.size[0] as f32, out.size[1] as f32)).collect();
                let holds = |block: &Block| block.source == boxes[b].4 && texels.iter().all(|at| (0..2).all(|k| {
                    let inside = at[k] - block.place[k] as f32;
                    inside >= 1.99 && inside <= block.size[k] as f32 - 1.99
                }));
                prop_assert!(out.blocks.iter().any(holds));
            }
        }
    }
}
