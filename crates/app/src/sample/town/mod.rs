//! An old town: rings of houses around courts, a church, a market square, a wall with towers and gates, trees.
//!
//! The streets are the edges of a grid of hand-placed crossings; every cell is a block, but for the market and
//! the churchyard, and the corners, which are gardens. Everything that varies is drawn from one seed.

mod church;
mod fortification;
mod house;
mod lamps;
mod layout;
mod market;
mod roofs;
mod trees;

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::Vec2;
use umbrae_core::{Mesh, Scene};

use self::house::House;
use self::layout::{Block, Plot};
use super::model::{Model, Paint, Parts, standing, wall};
use crate::random::Random;

const SEED: u64 = 2007;

/// The colours of the town.
#[derive(Debug)]
struct Paints {
    plasters: [Paint; 8],
    tiles: [Paint; 5],
    render: Paint,
    stone: Paint,
    copper: Paint,
    brick: Paint,
    timber: Paint,
    window: Paint,
    clock: Paint,
    cloths: [Paint; 3],
    bark: Paint,
    leaves: [Paint; 3],
}

impl Paints {
    fn new(model: &mut Model) -> Self {
        Self {
            plasters: [
                ("cream plaster", [0.68, 0.60, 0.45]),
                ("ochre plaster", [0.60, 0.43, 0.20]),
                ("white plaster", [0.70, 0.68, 0.62]),
                ("rose plaster", [0.58, 0.36, 0.29]),
                ("sage plaster", [0.42, 0.46, 0.33]),
                ("blue-grey plaster", [0.40, 0.45, 0.49]),
                ("sand plaster", [0.58, 0.50, 0.37]),
                ("apricot plaster", [0.64, 0.44, 0.28]),
            ]
            .map(|(name, color)| model.paint(name, color)),
            tiles: [
                ("terracotta", [0.38, 0.155, 0.09]),
                ("old terracotta", [0.30, 0.125, 0.08]),
                ("orange terracotta", [0.43, 0.19, 0.10]),
                ("brown tiles", [0.25, 0.115, 0.075]),
                ("pale terracotta", [0.42, 0.225, 0.145]),
            ]
            .map(|(name, color)| model.paint(name, color)),
            render: model.paint("church plaster", [0.70, 0.65, 0.54]),
            stone: model.paint("stone", [0.42, 0.38, 0.31]),
            copper: model.paint("copper", [0.16, 0.30, 0.26]),
            brick: model.paint("brick", [0.36, 0.17, 0.11]),
            timber: model.paint("timber", [0.13, 0.075, 0.04]),
            window: model.paint("window", [0.055, 0.07, 0.09]),
            clock: model.paint("gilt", [0.66, 0.46, 0.13]),
            cloths: [
                ("red cloth", [0.50, 0.06, 0.05]),
                ("blue cloth", [0.08, 0.17, 0.36]),
                ("linen", [0.70, 0.66, 0.55]),
            ]
            .map(|(name, color)| model.paint(name, color)),
            bark: model.paint("bark", [0.14, 0.09, 0.055]),
            leaves: [
                ("lime leaves", [0.15, 0.27, 0.05]),
                ("oak leaves", [0.09, 0.19, 0.045]),
                ("olive leaves", [0.19, 0.24, 0.08]),
            ]
            .map(|(name, color)| model.paint(name, color)),
        }
    }
}

/// The town by day.
pub(super) fn scene() -> Scene {
    model().into_scene()
}

/// The same town, under street lamps.
pub(super) fn scene_by_night() -> Scene {
    let mut model = model();
    lamps::add(&mut model);
    model.into_scene()
}

fn model() -> Model {
    let mut model = Model::default();
    let paints = Paints::new(&mut model);
    let mut random = Random::new(SEED);
    let mut town =
        Town { tree_kinds: trees::kinds(&paints, &mut random), model, paints, random, houses: 0, sheds: 0, trees: 0 };
    for block in layout::blocks() {
        town.add_block(&block);
    }
    town.add_gardens();
    town.add_churchyard();
    town.add_market();
    town.add_street_trees();
    fortification::add(&mut town.model, &town.paints);
    town.model
}

/// The town that is being built.
#[derive(Debug)]
struct Town {
    model: Model,
    paints: Paints,
    random: Random,
    tree_kinds: Vec<Arc<Mesh>>,
    houses: u16,
    sheds: u16,
    trees: u16,
}

impl Town {
    /// A ring of houses, and in the court behind them sheds and trees.
    fn add_block(&mut self, block: &Block) {
        for plot in block.plots(&mut self.random) {
            self.add_row_house(&plot);
        }
        let court = block.court();
        for _ in 0..self.random.pick(&[3, 4, 5]) {
            let at = court.point(self.random.between(0.08, 0.92), self.random.between(0.08, 0.92));
            self.add_tree("court", at, 0.0);
        }
        if self.random.chance(0.7) {
            self.sheds += 1;
            let shed = House {
                width: self.random.between(7.0, 10.0),
                depth: self.random.between(4.5, 5.5),
                storeys: 1,
                slope: 0.6,
                is_gable_fronted: false,
                is_hipped: false,
                side_windows: [false; 2],
                dormers: 0,
            };
            let at = court.point(self.random.between(0.35, 0.65), self.random.between(0.2, 0.8));
            let angle = court.angle() + self.random.pick(&[0.0, 0.25, 0.5, 0.75]) * TAU;
            self.place_house(format!("shed {}", self.sheds), &shed, at, angle);
        }
    }

    fn add_row_house(&mut self, plot: &Plot) {
        let random = &mut self.random;
        let is_gable_fronted = !plot.is_corner && plot.width < 14.5 && random.chance(0.38);
        let span = if is_gable_fronted { plot.width } else { plot.depth };
        let house = House {
            // A little wider than the plot: neighbours grow into each other instead of touching.
            width: plot.width + 0.5,
            depth: plot.depth,
            storeys: random.pick(&[1, 2, 2, 2, 3, 3]),
            slope: random.between(0.72, 1.05) * if span > 12.0 { 0.85 } else { 1.0 },
            is_gable_fronted,
            is_hipped: !is_gable_fronted
                && plot.width > plot.depth + 0.5
                && random.chance(if plot.is_corner { 0.7 } else { 0.1 }),
            side_windows: [plot.is_corner, false],
            dormers: if is_gable_fronted { 0 } else { random.pick(&[0, 0, 1, 2]) },
        };
        let angle = plot.angle + random.between(-0.02, 0.02);
        self.add_house(&house, plot.center, angle);
    }

    fn add_house(&mut self, house: &House, at: Vec2, angle: f32) {
        self.houses += 1;
        self.place_house(format!("house {}", self.houses), house, at, angle);
    }

    fn place_house(&mut self, name: String, house: &House, at: Vec2, angle: f32) {
        let mesh = house.parts(&self.paints, &mut self.random).into_mesh();
        self.model.place(name, Arc::new(mesh), standing(at, angle, 1.0));
    }

    /// A tree near `at`, named for the kind of place: "trees court 3".
    fn add_tree(&mut self, place: &str, at: Vec2, jitter: f32) {
        let random = &mut self.random;
        self.trees += 1;
        let at = at + jitter * Vec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        let kind = random.pick(&self.tree_kinds);
        let scale = if place == "street" { random.between(0.62, 0.76) } else { random.between(0.8, 1.2) };
        self.model.place(format!("trees {place} {}", self.trees), kind, standing(at, random.between(0.0, TAU), scale));
    }

    /// The four corners of the town: two houses in a garden each.
    fn add_gardens(&mut self) {
        for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
            let corner = Vec2::new(x, y);
            for (at, turn) in [(Vec2::new(91.0, 79.0), 0.12), (Vec2::new(114.0, 74.0), -0.1)] {
                let house = House {
                    width: self.random.between(12.0, 14.0),
                    depth: self.random.between(9.0, 10.5),
                    storeys: self.random.pick(&[1, 2]),
                    slope: self.random.between(0.8, 1.0),
                    is_gable_fronted: false,
                    is_hipped: self.random.chance(0.6),
                    side_windows: [true; 2],
                    dormers: self.random.pick(&[0, 1, 2]),
                };
                let angle = turn * x * y + if y < 0.0 { 0.5 * TAU } else { 0.0 };
                self.add_house(&house, at * corner, angle);
            }
            let places =
                [(80.0, 106.0), (80.0, 95.0), (88.0, 99.0), (97.0, 92.0), (78.0, 86.0), (103.0, 84.0), (126.0, 74.0)];
            for at in places {
                self.add_tree("garden", Vec2::from(at) * corner, 1.0);
            }
        }
    }

    fn add_churchyard(&mut self) {
        let (at, angle) = (Vec2::new(27.0, 34.0), 0.07);
        self.model.place("church", Arc::new(church::parts(&self.paints).into_mesh()), standing(at, angle, 1.0));
        let out = Vec2::from_angle(angle);
        let yard = [(-30.0, -19.0), (31.0, -19.0), (31.0, 19.5), (-30.0, 19.5)].map(|p| at + out.rotate(Vec2::from(p)));
        let mut stones = Parts::default();
        // A low wall on three sides; to the south, the yard is open to the market.
        for (i, (from, to)) in [(1, 2), (2, 3), (3, 0)].into_iter().enumerate() {
            let height = 1.5 + 0.05 * i as f32;
            stones.add(self.paints.stone, wall(yard[from], yard[to], 0.5, 0.0, height));
        }
        self.model.add("wall churchyard", stones);
        let places = [
            (-27.0, 15.0),
            (-19.0, 16.5),
            (-7.0, 16.0),
            (5.0, 16.5),
            (17.0, 16.0),
            (27.5, 14.0),
            (28.0, -2.0),
            (27.5, -13.5),
            (-27.0, -14.0),
        ];
        for place in places {
            self.add_tree("churchyard", at + out.rotate(place.into()), 0.6);
        }
    }

    fn add_market(&mut self) {
        market::add(&mut self.model, &self.paints, &mut self.random);
        for i in 0..7 {
            self.add_tree("market", Vec2::new(-2.0 + 6.5 * i as f32, -46.5 - 0.35 * i as f32), 0.5);
        }
    }

    /// Two rows along the widest street, from gate to gate but for the market.
    fn add_street_trees(&mut self) {
        for place in layout::avenue() {
            self.add_tree("street", place, 0.4);
        }
    }
}
