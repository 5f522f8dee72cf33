//! The animations of a glTF file: which nodes they move, and along which keys.
//!
//! What can't be followed is skipped channel by channel, with a warning; nothing here is an error.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::accessor::Accessors;
use super::document::{self, Document};
use super::node::Tree;
use super::sampler::{Interpolation, Track, check_times};
use crate::error::{Problem, quoted};
use crate::warnings::{Warnings, Words};

/// What a channel moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Path {
    Translation,
    Rotation,
    Scale,
    /// Of the morph targets.
    Weights,
}

impl Path {
    fn of_name(name: &str) -> Option<Self> {
        Some(match name {
            "translation" => Self::Translation,
            "rotation" => Self::Rotation,
            "scale" => Self::Scale,
            "weights" => Self::Weights,
            _ => return None,
        })
    }
}

/// One thing that an animation moves.
#[derive(Debug, Clone)]
pub(crate) struct Channel {
    /// Index into the file's nodes; it is in the scene.
    pub(crate) node: usize,
    pub(crate) path: Path,
    pub(super) track: Track,
}

/// An animation: its channels act together, and no two of them on the same path of a node.
#[derive(Debug, Clone)]
pub(crate) struct Clip {
    pub(crate) name: String,
    /// The time of the last key.
    pub(crate) duration_s: f64,
    pub(crate) channels: Vec<Channel>,
}

const SKIPPED: Words = ["animation channel was skipped", "animation channels were skipped"];

/// All animations of the file, in its order.
pub(super) fn clips(document: &Document, accessors: &Accessors<'_>, tree: &Tree, warnings: &mut Warnings) -> Vec<Clip> {
    let mut keys = Keys { accessors, times: BTreeMap::new(), values: BTreeMap::new(), tracks: BTreeMap::new() };
    let clip = |(index, animation): (usize, &document::Animation)| {
        let mut channels: Vec<Channel> = Vec::new();
        let mut seen = BTreeSet::new();
        for (number, channel) in animation.channels.iter().enumerate() {
            let read = keys.channel(channel, animation, document, tree).and_then(|channel| match channel {
                Some(channel) if !seen.insert((channel.node, channel.path)) => {
                    Err(format!("it moves what a channel before it moves, the same path of node {}", channel.node))
                }
                other => Ok(other),
            });
            match read {
                Ok(channel) => channels.extend(channel),
                Err(message) => warnings.add_one(SKIPPED, || {
                    let message = format!("channel {number}: {message}");
                    Problem::in_part("animation", index, animation.name.as_deref(), message).to_string()
                }),
            }
        }
        let name = animation.name.as_deref().filter(|name| !name.is_empty());
        Clip {
            name: name.map_or_else(|| format!("animation {index}"), str::to_owned),
            duration_s: channels.iter().map(|channel| channel.track.end_s()).fold(0.0, f64::max),
            channels,
        }
    };
    document.animations.iter().enumerate().map(clip).collect()
}

/// Times or values of keys; reading them is tried once.
type Numbers = Result<Arc<[f64]>, String>;

/// What makes a track: input, output, what is moved, the numbers of a value, and the way between keys.
type TrackKey = (usize, usize, Path, usize, Interpolation);

/// Keys as they are read, and checked once: many channels share their times, and a hostile file's all of it.
struct Keys<'a> {
    accessors: &'a Accessors<'a>,
    times: BTreeMap<usize, Numbers>,
    /// By accessor and numbers in an element.
    values: BTreeMap<(usize, usize), Numbers>,
    tracks: BTreeMap<TrackKey, Result<Track, String>>,
}

impl Keys<'_> {
    /// What is wrong is said in words that fit after "channel 3: "; `None` for what is not in the scene.
    fn channel(
        &mut self,
        channel: &document::Channel,
        animation: &document::Animation,
        document: &Document,
        tree: &Tree,
    ) -> Result<Option<Channel>, String> {
        let name = &channel.target.path;
        let path = Path::of_name(name)
            .ok_or_else(|| format!("it moves {}, not translation, rotation, scale or weights", quoted(name)))?;
        let index = channel.target.node.ok_or("it moves no node")?;
        let nodes = &document.nodes;
        let node = nodes.get(index).ok_or_else(|| format!("it moves node {index}, but there are {}", nodes.len()))?;
        if tree.place_of_node(index).is_none() {
            return Ok(None);
        }
        let width = match path {
            Path::Translation | Path::Scale => 3,
            Path::Rotation => 4,
            Path::Weights => {
                node.mesh.and_then(|mesh| document.meshes.get(mesh as usize)).map_or(0, document::Mesh::target_count)
            }
        };
        if width == 0 {
            return Err(format!("it moves the weights of node {index}, which has no morph targets"));
        }
        if path != Path::Weights && node.matrix.is_some() {
            return Err(format!("it moves node {index}, which has a matrix in place of parts that can be moved"));
        }
        let sampler = channel.sampler.ok_or("it has no sampler")?;
        let track = self
            .track(sampler, animation, path, width)
            .map_err(|message| format!("its sampler {sampler}: {message}"))?;
        Ok(Some(Channel { node: index, path, track }))
    }

    fn track(
        &mut self,
        index: usize,
        animation: &document::Animation,
        path: Path,
        width: usize,
    ) -> Result<Track, String> {
        let samplers = &animation.samplers;
        let sampler = samplers.get(index).ok_or_else(|| format!("it does not exist; there are {}", samplers.len()))?;
        let interpolation = match sampler.interpolation.as_deref() {
            None => Interpolation::Linear,
            Some(name) => {
                Interpolation::of_name(name).ok_or_else(|| format!("there is no interpolation {}", quoted(name)))?
            }
        };
        let input = sampler.input.ok_or("it has no input")?;
        let output = sampler.output.ok_or("it has no output")?;
        let key = (input, output, path, width, interpolation);
        if let Some(track) = self.tracks.get(&key) {
            return track.clone();
        }
        let track = self.new_track(key);
        self.tracks.insert(key, track.clone());
        track
    }

    fn new_track(&mut self, (input, output, path, width, interpolation): TrackKey) -> Result<Track, String> {
        let times_s = self.times(input)?;
        let values = match path {
            Path::Translation | Path::Scale => self.values::<3>(output),
            Path::Rotation => self.values::<4>(output),
            Path::Weights => self.values::<1>(output),
        }?;
        let track = Track::new(times_s, values, width, interpolation)?;
        if path == Path::Rotation {
            track.check_rotations()?;
        }
        Ok(track)
    }

    fn times(&mut self, accessor: usize) -> Numbers {
        if let Some(times_s) = self.times.get(&accessor) {
            return times_s.clone();
        }
        let times_s = self.values::<1>(accessor).and_then(|times_s| check_times(&times_s).map(|()| times_s));
        self.times.insert(accessor, times_s.clone());
        times_s
    }

    fn values<const N: usize>(&mut self, accessor: usize) -> Numbers {
        let accessors = self.accessors;
        let read = || {
            let vectors = accessors.vectors::<N>(accessor)?;
            // What is kept takes twice the memory of the f32 that everything else becomes.
            accessors.charge(vectors.len(), N)?;
            Ok(vectors.into_flattened().into())
        };
        self.values.entry((accessor, N)).or_insert_with(read).clone()
    }
}

impl document::Mesh {
    /// Morph targets; those of the primitive that has the most, where they differ.
    pub(super) fn target_count(&self) -> usize {
        self.primitives.iter().map(|primitive| primitive.targets.len()).max().unwrap_or(0)
    }
}
