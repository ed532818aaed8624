//! Animations of what a rig keeps (glTF 2.0, 3.11): channels of nodes as they are, channels of morph weights put
//! together for the one mesh that there is.
//!
//! Contract: a channel that cannot be used is left out with a warning; so is what moves no vertex, without one.

use super::accessor::Accessor;
use super::buffers::{Buffers, pointer};
use super::json_motion::{AnimationSampler, Channel};
use super::morphs::Morphs;
use super::weight_tracks::{MOST_SAMPLES, WeightTrack, together};
use crate::FileError;
use parbake_model::glam::Quat;
use parbake_model::{Animation, Interpolation, Property, Track};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Bytes of a number.
const NUMBER: u64 = 4;
/// How far the length of a quaternion may be from 1.
const UNIT: f32 = 1e-4;

/// Reads animations; samplers often share their accessors.
pub(super) struct Animations<'a, 'd> {
    buffers: &'a Buffers<'d>,
    read: HashMap<(usize, usize), Arc<Vec<f32>>>,
}

/// A sampler's numbers.
struct Sampled {
    interpolation: Interpolation,
    times: Arc<Vec<f32>>,
    values: Arc<Vec<f32>>,
}

impl<'a, 'd> Animations<'a, 'd> {
    /// All animations; `places` are the rig's nodes for the document's.
    ///
    /// # Errors
    /// Where they take more bytes than a file may.
    pub fn of(
        buffers: &'a Buffers<'d>,
        places: &[Option<usize>],
        morphs: &Morphs,
    ) -> Result<Vec<Animation>, FileError> {
        let mut own = Self { buffers, read: HashMap::new() };
        let mut animations = Vec::new();
        for (index, json) in buffers.document.animations.iter().enumerate() {
            let mut tracks = Vec::new();
            let mut taken: HashSet<Property> = HashSet::new();
            let mut weights: Vec<WeightTrack> = Vec::new();
            for (k, channel) in json.channels.iter().enumerate() {
                let here = format!("/animations/{index}/channels/{k}");
                if channel.target.path == "pointer" {
                    buffers.context.warn("animations of KHR_animation_pointer were left out");
                }
                let Some(node) = channel.target.node else { continue };
                let property = places.get(node).copied().flatten().and_then(|place| {
                    Some(match channel.target.path.as_str() {
                        "translation" => Property::Translation(place),
                        "rotation" => Property::Rotation(place),
                        "scale" => Property::Scale(place),
                        _ => return None,
                    })
                });
                let ids = morphs.of_nodes.get(&node).filter(|_| channel.target.path == "weights");
                let (width, normalise) = match (property, ids) {
                    (Some(property), _) if taken.insert(property) => {
                        (property.width(0), matches!(property, Property::Rotation(_)))
                    }
                    (None, Some(ids)) if !ids.is_empty() => (ids.len(), false),
                    _ => continue,
                };
                let Some(sampled) = own.sampled(channel, &json.samplers, width, normalise, &here)? else {
                    continue;
                };
                let Sampled { interpolation, times, values } = sampled;
                match (property, ids) {
                    (Some(property), _) => tracks.push(Track { property, interpolation, times, values }),
                    (None, Some(ids)) => {
                        weights.push(WeightTrack { targets: ids.clone(), interpolation, times, values });
                    }
                    (None, None) => {}
                }
            }
            let rest: Vec<f32> = morphs.targets.iter().map(|target| target.weight).collect();
            // Values of a target are said anew at the times of all others.
            let samples = weights.iter().map(|track| track.values.len() / track.targets.len()).sum::<usize>()
                + if weights.len() > 1 { MOST_SAMPLES } else { 0 };
            let bytes = NUMBER.saturating_mul((samples as u64).saturating_mul(rest.len() as u64));
            if !weights.is_empty() {
                buffers.add_bytes(bytes, pointer(format!("/animations/{index}")))?;
            }
            if let Some((track, is_exact)) = together(weights, &rest) {
                if !is_exact {
                    buffers
                        .context
                        .warn("weights of morph targets that several nodes animate were sampled anew");
                }
                tracks.push(track);
            }
            if !tracks.is_empty() {
                animations.push(Animation { name: json.name.clone(), tracks });
            }
        }
        Ok(animations)
    }

    /// A channel's numbers, `width` for each value; none where they are not sound.
    fn sampled(
        &mut self,
        channel: &Channel,
        samplers: &[AnimationSampler],
        width: usize,
        normalise: bool,
        here: &str,
    ) -> Result<Option<Sampled>, FileError> {
        let context = self.buffers.context;
        let left_out = |reason: &str| {
            context.warn(format!("{here} was left out: {reason}"));
            Ok(None)
        };
        let sampler = channel.sampler.and_then(|index| samplers.get(index));
        let Some((sampler, input, output)) = sampler.and_then(|s| Some((s, s.input?, s.output?))) else {
            return left_out("it has no sampler, or one without input or output");
        };
        let interpolation = match sampler.interpolation.as_deref() {
            Some("STEP") => Interpolation::Step,
            Some("LINEAR") | None => Interpolation::Linear,
            Some("CUBICSPLINE") => Interpolation::CubicSpline,
            Some(_) => return left_out("its interpolation is not known"),
        };
        let (times, values) = match (self.numbers(input, 1, here)?, self.numbers(output, width, here)?) {
            (Ok(times), Ok(values)) => (times, values),
            (Err(reason), _) | (_, Err(reason)) => return left_out(&reason),
        };
        let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if values.len() != parts * width * times.len() {
            return left_out("its times and values differ in number");
        }
        if times.windows(2).any(|w| w[0] >= w[1]) || times.first().is_some_and(|&first| first < 0.0) {
            return left_out("its times do not increase from 0");
        }
        let values = if normalise { unit_quaternions(values, parts) } else { values };
        Ok(Some(Sampled { interpolation, times, values }))
    }

    /// The numbers of an accessor of elements of `width`, or single ones; the inner error says why there are none.
    fn numbers(
        &mut self,
        index: usize,
        width: usize,
        here: &str,
    ) -> Result<Result<Arc<Vec<f32>>, String>, FileError> {
        // Weights of morph targets are single numbers.
        let width = if matches!(width, 3 | 4) && self.kind_of(index) != "SCALAR" { width } else { 1 };
        if let Some(found) = self.read.get(&(index, width)) {
            return Ok(Ok(found.clone()));
        }
        let accessor = match Accessor::new(self.buffers, index, here, &[width]) {
            Ok(accessor) => accessor,
            Err(error) => return Ok(Err(error.to_string())),
        };
        self.buffers.add_bytes(NUMBER * (width * accessor.count) as u64, pointer(here.into()))?;
        let mut numbers = Vec::with_capacity(width * accessor.count);
        for element in 0..accessor.count {
            numbers.extend_from_slice(&accessor.read(element, [0.0f32; 4])[..width]);
        }
        if numbers.iter().any(|x| !x.is_finite()) {
            return Ok(Err("a number of it is not finite".into()));
        }
        let numbers = Arc::new(numbers);
        self.read.insert((index, width), numbers.clone());
        Ok(Ok(numbers))
    }

    fn kind_of(&self, accessor: usize) -> &str {
        self.buffers.document.accessors.get(accessor).map_or("", |accessor| &accessor.kind)
    }
}

/// Rotations of unit length; as they are where they have it. Tangents of splines stay.
fn unit_quaternions(values: Arc<Vec<f32>>, parts: usize) -> Arc<Vec<f32>> {
    let is_value = |k: usize| parts == 1 || k % parts == 1;
    let is_off = |(k, q): (usize, &[f32])| is_value(k) && (Quat::from_slice(q).length() - 1.0).abs() > UNIT;
    if !values.chunks_exact(4).enumerate().any(is_off) {
        return values;
    }
    let unit = |(k, q): (usize, &[f32])| match is_value(k) {
        true => {
            let length = Quat::from_slice(q).length();
            if length > 0.0 { (Quat::from_slice(q) / length).to_array() } else { [0.0, 0.0, 0.0, 1.0] }
        }
        false => Quat::from_slice(q).to_array(),
    };
    Arc::new(values.chunks_exact(4).enumerate().flat_map(unit).collect())
}
