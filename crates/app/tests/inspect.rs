//! `inspect` against what others measured: the counts of `SOURCES.md`, which lies beside the real models.
//!
//! For every model that the program reads: how many triangles it has, whether it is closed, and how many edges are border, non-manifold and
//! inconsistently wound.
//! Prints a table. The disagreements that we know are listed with their reasons; a new one fails the test, and so does one that has gone.

mod data;

use std::fs;
use std::path::Path;

use umbrae::cli::ColorWhen;
use umbrae::inspect::{Counts, Inspection};
use umbrae::model::load_one;
use umbrae::talk::Talk;
use umbrae_formats::LoadOptions;

/// Models on which all must agree.
const LEAST_AGREEING: usize = 90;

/// What we count otherwise, and why.
const KNOWN: [(&str, &str); 4] = [
    (
        "gltf/MultipleScenes/MultipleScenes.gltf",
        "all of its scenes were measured; we show the one that it has shown by default",
    ),
    ("nasty/BoxWithInfinites.glb", "infinite coordinates are refused"),
    (
        "nasty/concave_polygon.obj",
        "a ring with a bridge to its hole was measured as a fan, which is not its surface; 64 of its sides border on nothing",
    ),
    ("nasty/integer-out-of-bounds.gltf", "a view of 1e300 bytes is refused"),
];

/// What is compared.
#[derive(Debug, PartialEq, Eq)]
struct Edges {
    triangles: usize,
    is_closed: bool,
    border: usize,
    non_manifold: usize,
    inconsistent: usize,
}

impl From<&Counts> for Edges {
    fn from(counts: &Counts) -> Self {
        Self {
            triangles: counts.triangles,
            is_closed: counts.closed,
            border: counts.border_edges,
            non_manifold: counts.non_manifold_edges,
            inconsistent: counts.inconsistent_edges,
        }
    }
}

/// One line of `SOURCES.md` about a surface.
struct Measured {
    path: String,
    edges: Edges,
    /// Whether each edge is walked equally often in both directions, where the line says so.
    is_balanced: Option<bool>,
}

/// The lines of `text` that are about a surface in a file of a format that we read.
fn measured(text: &str) -> Vec<Measured> {
    text.lines().filter_map(measured_in_line).collect()
}

/// `| gltf/Fox.glb | 162852 | 576 tri (…), …; open, 3 boundary edges; … | …`
fn measured_in_line(line: &str) -> Option<Measured> {
    let mut columns = line.strip_prefix("| ")?.split(" | ");
    let (path, what) = (columns.next()?.to_owned(), columns.nth(1)?);
    umbrae_formats::Format::of_path(Path::new(&path))?;
    // The part that tells of edges is one of those between semicolons.
    let edges =
        what.split("; ").find(|part| ["closed", "open,", "no boundary"].iter().any(|word| part.starts_with(word)))?;
    let count = |of_what: &str| {
        let count = edges.split(", ").find_map(|words| words.strip_suffix(of_what)?.trim().parse::<usize>().ok());
        count.unwrap_or(0)
    };
    let triangles = what.split_once(" tri")?.0.parse().ok()?;
    let (border, non_manifold) = (count("boundary edges"), count("non-manifold edges"));
    let is_closed = edges.starts_with("closed");
    assert_eq!(is_closed, border + non_manifold == 0, "SOURCES.md contradicts itself: {line}");
    let is_balanced = match () {
        () if edges.contains("unbalanced edges") => Some(false),
        () if edges.contains("edge-balanced") => Some(true),
        () => None,
    };
    let inconsistent = count("inconsistently wound edges");
    Some(Measured { path, edges: Edges { triangles, is_closed, border, non_manifold, inconsistent }, is_balanced })
}

/// Why ours is not what was measured, if it is not.
fn disagreement(folder: &Path, measured: &Measured) -> Option<String> {
    let path = folder.join(&measured.path);
    let model = match load_one(&path, &LoadOptions::default(), &Talk::new(true, ColorWhen::Never)) {
        Ok(model) => model,
        Err(error) => return Some(format!("can't be read: {error}")),
    };
    let inspection = Inspection::new(measured.path.clone(), &model);
    let ours = Edges::from(inspection.total());
    if ours != measured.edges {
        return Some(format!("counted {ours:?}, measured {:?}", measured.edges));
    }
    let is_balanced = inspection.total().components.other == 0;
    let is_other = measured.is_balanced.is_some_and(|measured| measured != is_balanced);
    is_other.then(|| format!("balanced: {is_balanced}, measured: {:?}", measured.is_balanced))
}

#[test]
fn inspect_counts_what_others_measured() {
    let Some(folder) = data::folder() else { return };
    let sources = fs::read_to_string(folder.join("SOURCES.md")).expect("the data folder is complete");
    let measured = measured(&sources);
    let names: Vec<&str> = measured.iter().map(|m| m.path.as_str()).collect();
    for path in data::models(&folder) {
        let name =
            path.strip_prefix(&folder).expect("it is in there").to_str().expect("names are UTF-8").replace('\\', "/");
        assert!(names.contains(&name.as_str()), "SOURCES.md has no counts of {name}");
    }

    let mut agreeing = 0;
    let mut wrong = Vec::new();
    for line in &measured {
        let difference = disagreement(&folder, line);
        let reason = KNOWN.iter().find(|(name, _)| *name == line.path).map(|(_, reason)| reason);
        println!("{:<60} {}", line.path, difference.as_deref().unwrap_or("agrees"));
        match (&difference, reason) {
            (None, None) => agreeing += 1,
            (Some(_), Some(reason)) => println!("{:<60}   because {reason}", ""),
            (Some(difference), None) => wrong.push(format!("{}: {difference}", line.path)),
            (None, Some(_)) => wrong.push(format!("{} agrees: take it off the list", line.path)),
        }
    }
    println!("{agreeing} of {} agree", measured.len());
    let unused = KNOWN.iter().filter(|(name, _)| !names.contains(name));
    wrong.extend(unused.map(|(name, _)| format!("{name} is on the list and not in SOURCES.md")));
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(agreeing >= LEAST_AGREEING, "only {agreeing} models agree");
}

#[test]
fn lines_of_the_sources_are_read_as_they_are_meant() {
    let read = |what: &str| measured_in_line(&format!("| mesh/x.obj | 12 | {what} | a @ b | MIT | A |  |"));
    let edges = |what: &str| read(what).expect(what).edges;
    let expected = |triangles, border, non_manifold, inconsistent| Edges {
        triangles,
        is_closed: border + non_manifold == 0,
        border,
        non_manifold,
        inconsistent,
    };
    assert_eq!(edges("12 tri (12 instanced in default scene), 1 meshes; closed; trimesh ok"), expected(12, 0, 0, 0));
    assert_eq!(edges("32 tri; closed, manifold edges, 12 inconsistently wound edges"), expected(32, 0, 0, 12));
    assert_eq!(
        edges("9 tri; open, 82 boundary edges, 133 non-manifold edges, 10 inconsistently wound edges, 8 zero-area"),
        expected(9, 82, 133, 10)
    );
    assert_eq!(edges("9 tri; open, manifold edges, 3 boundary edges; 1 bad statements/faces"), expected(9, 3, 0, 0));
    assert_eq!(read("9 tri; no boundary, 3 non-manifold edges, edge-balanced").and_then(|m| m.is_balanced), Some(true));
    assert_eq!(
        read("9 tri; no boundary, 5 non-manifold edges, 4 unbalanced edges").and_then(|m| m.is_balanced),
        Some(false)
    );
    for nothing in ["0 tri, 0 verts; no faces", "does not parse (a referenced file is missing)", "companion/text"] {
        assert!(read(nothing).is_none(), "{nothing}");
    }
}
