//! Models into what is there before and after.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use umbrae_core::{Bounds, Caster, Scene, SurfaceKind};
use umbrae_formats::Crs;
use umbrae_study::{Blockers, GroundLevel, Solids, Terrain, kind_of_triangles};

use crate::cli::StudyArgs;
use crate::model::{LoadedFile, load_all};
use crate::talk::Talk;

/// When an object is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum When {
    /// Before and after.
    Always,
    /// It goes.
    Before,
    /// It comes.
    After,
}

/// All models of a study in one space.
#[derive(Debug)]
pub(crate) struct Models {
    pub(crate) scene: Scene,
    /// One for each of the scene's objects, in order.
    pub(crate) casters: Vec<Caster>,
    /// When each is there.
    pub(crate) when: Vec<When>,
    /// For each caster what its triangles are parts of.
    pub(crate) kinds: Vec<Vec<SurfaceKind>>,
    /// On what the objects stand.
    pub(crate) ground: GroundLevel,
    pub(crate) files: Vec<LoadedFile>,
    /// What the scene's origin plus a position is in, if any file says so.
    pub(crate) crs: Option<Crs>,
    pub(crate) warnings: Vec<String>,
}

/// What is there at once.
#[derive(Debug)]
pub(crate) struct Situation {
    /// "" where there is only one, else "before" or "after".
    pub(crate) name: &'static str,
    /// Which of [`Models::casters`] are there.
    pub(crate) objects: Vec<usize>,
    pub(crate) blockers: Blockers,
    pub(crate) solids: Solids,
    pub(crate) terrain: Terrain,
}

/// Higher than any building; a model of millimetres or feet is.
const SUSPICIOUS_HEIGHT_M: f64 = 1000.0;
/// Higher than a plinth, and than what a street rises along a block.
const SUSPICIOUS_SLOPE_M: f64 = 2.0;
/// Lower than a garden wall.
const SUSPICIOUS_LOWNESS_M: f64 = 0.5;

impl Models {
    /// Loads all models that `args` name.
    ///
    /// # Errors
    ///
    /// The first that can't be loaded or joined, with the reason.
    pub(super) fn load(args: &StudyArgs, talk: &Talk) -> anyhow::Result<Self> {
        let parts: [(&[PathBuf], When); 3] =
            [(&args.models, When::Always), (&args.existing, When::Before), (&args.proposed, When::After)];
        let (mut scene, mut when, mut files) = (Scene::default(), Vec::new(), Vec::new());
        let mut options = args.load.options();
        let mut said: Vec<Vec<String>> = Vec::new();
        for (paths, part) in parts {
            for path in paths {
                let (mut one, loaded) = load_all(std::slice::from_ref(path), &options, None, talk)?;
                options.into = options.into.or_else(|| loaded.iter().find_map(|file| file.crs.clone()));
                said.push(args.cast_choice().assign(&mut one));
                when.extend(std::iter::repeat_n(part, one.objects.len()));
                let cant = || format!("can't join `{}` with the models before it", path.display());
                scene.add(one).with_context(cant)?;
                files.extend(loaded);
            }
        }
        let casters = Caster::of_scene(&scene);
        let kinds: Vec<Vec<SurfaceKind>> = casters.iter().map(|c| kind_of_triangles(c, &scene.materials)).collect();
        let mut ground = GroundLevel::of(&casters, &kinds);
        if let Some(asked) = args.ground {
            ground = GroundLevel { level: asked - scene.origin.z, lowest: 0.0, highest: 0.0, objects: 0 };
        }
        let mut models = Self { scene, casters, when, kinds, ground, files, crs: options.into, warnings: Vec::new() };
        let size = models.bounds().size();
        ensure!(size.length() > 0.0, "every triangle of the models is a point, so there is nothing to study");
        models.warnings.extend(of_all(&said));
        models.warnings.extend(models.odd_sizes());
        models.warnings.extend(models.slope());
        Ok(models)
    }

    /// Holds everything.
    pub(crate) fn bounds(&self) -> Bounds {
        Caster::bounds_of(&self.casters)
    }

    /// Whether something comes or goes.
    pub(crate) fn is_compared(&self) -> bool {
        self.when.iter().any(|&when| when != When::Always)
    }

    /// The height of the ground where there is no terrain, scene space.
    pub(crate) fn ground_level(&self) -> f64 {
        self.ground.level
    }

    /// Whether any triangle is terrain.
    pub(crate) fn has_terrain(&self) -> bool {
        self.kinds.iter().flatten().any(|&kind| kind == SurfaceKind::Terrain)
    }

    /// What is there: one situation, or before and after.
    pub(crate) fn situations(&self) -> Vec<Situation> {
        let states: &[(&str, When)] = if self.is_compared() {
            &[("before", When::Before), ("after", When::After)]
        } else {
            &[("", When::Always)]
        };
        states.iter().map(|&(name, when)| self.situation(name, when)).collect()
    }

    fn situation(&self, name: &'static str, when: When) -> Situation {
        let is_there = |&i: &usize| self.when[i] == When::Always || self.when[i] == when;
        let objects: Vec<usize> = (0..self.casters.len()).filter(is_there).collect();
        let casters: Vec<Caster> = objects.iter().map(|&i| self.casters[i].clone()).collect();
        let kinds: Vec<Vec<SurfaceKind>> = objects.iter().map(|&i| self.kinds[i].clone()).collect();
        let blocking: Vec<Caster> = casters.iter().filter(|caster| caster.role.casts).cloned().collect();
        Situation {
            name,
            blockers: Blockers::new(&blocking),
            solids: Solids::new(&casters, &kinds),
            terrain: Terrain::new(&casters, &kinds),
            objects,
        }
    }

    /// A warning, if not all stand on one level and there is no terrain.
    fn slope(&self) -> Option<String> {
        let GroundLevel { level, lowest, highest, objects } = self.ground;
        let is_level = highest - lowest <= SUSPICIOUS_SLOPE_M;
        let z = self.scene.origin.z;
        (!is_level && !self.has_terrain()).then(|| {
            format!(
                "the models have no terrain, and their {objects} objects stand between {:.1} and {:.1} m: the ground is taken as level at {:.1} m, and shadows on it are \
                 where they would be at that level; add a model of the terrain, or give --ground",
                lowest + z,
                highest + z,
                level + z
            )
        })
    }

    fn odd_sizes(&self) -> Option<String> {
        let height = self.bounds().size().z;
        if height > SUSPICIOUS_HEIGHT_M && !self.has_terrain() {
            return Some(format!(
                "the models are {height:.0} m high: coordinates are taken as metres, and no building is so high; are they millimetres or feet?"
            ));
        }
        (height < SUSPICIOUS_LOWNESS_M).then(|| {
            format!("the models are {height:.3} m high: coordinates are taken as metres; are they kilometres, or is another axis up (--up)?")
        })
    }
}

/// Those of the first file's warnings that every other file has as well, whatever closest names each offers: a name that is in one of them is found.
fn of_all(said: &[Vec<String>]) -> Vec<String> {
    let sentence = |warning: &str| warning.split(';').next().unwrap_or_default().to_owned();
    let Some((first, others)) = said.split_first() else { return Vec::new() };
    let is_in = |warning: &str, other: &[String]| other.iter().any(|w| sentence(w) == sentence(warning));
    first.iter().filter(|warning| others.iter().all(|other| is_in(warning, other))).cloned().collect()
}

/// The file's name without folders.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}
