//! Files that the program is given, and the folder in which it works.

use std::fs;
use std::path::PathBuf;

use assert_cmd::assert::Assert;
use assert_cmd::cargo::cargo_bin;
use serde_json::{Value, json};
use tempfile::TempDir;

/// A box of 2 m that stands on the ground in the middle, in an OBJ file with y up.
pub(crate) const BOX: &str = "\
v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1
f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";

/// [`BOX`] moved by `offset`, in the file's axes.
pub(crate) fn box_at(offset: [f64; 3]) -> String {
    let moved = |line: &str| {
        let Some(vertex) = line.strip_prefix("v ") else { return format!("{line}\n") };
        let coordinates = vertex.split(' ').zip(offset).map(|(c, o)| c.parse::<f64>().expect("a number") + o);
        format!("v {}\n", coordinates.map(|c| c.to_string()).collect::<Vec<_>>().join(" "))
    };
    BOX.lines().map(moved).collect()
}

/// A folder with models in it, and a folder `out` in it to write to.
pub(crate) struct Place(TempDir);

impl Place {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::create_dir(folder.path().join("out")).expect("a folder in it");
        Self(folder)
    }

    /// The path of a name in the folder.
    pub(crate) fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("its path is UTF-8").to_owned()
    }

    /// The path of a name to write to.
    pub(crate) fn out(&self, name: &str) -> String {
        self.path(&format!("out/{name}"))
    }

    /// Writes a file, and returns its path.
    pub(crate) fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        fs::write(&path, content).expect("the folder can be written");
        path
    }

    /// The names in `out`, in order, hidden ones too.
    pub(crate) fn written(&self) -> Vec<String> {
        self.names("out")
    }

    fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.0.path().join(folder)).expect("a folder that can be read");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    pub(crate) fn std_command(&self, args: &[&str]) -> std::process::Command {
        let mut command = std::process::Command::new(program());
        command.args(args).current_dir(self.0.path()).env_remove("NO_COLOR");
        command
    }

    pub(crate) fn command(&self, args: &[&str]) -> assert_cmd::Command {
        assert_cmd::Command::from_std(self.std_command(args))
    }

    /// Runs the program.
    pub(crate) fn umbrae(&self, args: &[&str]) -> Assert {
        self.command(args).assert()
    }

    /// Runs the program, which must refuse: exit code 2, one sentence with `words` on standard error and perhaps its cause, nothing on
    /// standard output, and no file more or less than before.
    pub(crate) fn refuses(&self, args: &[&str], words: &[&str]) {
        let before = [self.names("."), self.names("out")];
        let assert = self.umbrae(args).code(2).stdout("");
        let said = String::from_utf8(assert.get_output().stderr.clone()).expect("what is said is text");
        assert_one_sentence(args, &said, words);
        assert_eq!([self.names("."), self.names("out")], before, "{args:?} left a file");
    }
}

/// `said` is an error in one sentence, perhaps with its cause or the hint of the command line, and has `words`.
pub(crate) fn assert_one_sentence(args: &[&str], said: &str, words: &[&str]) {
    let lines: Vec<&str> = said.lines().collect();
    let is_good = match lines[..] {
        [error] => error.starts_with("error: "),
        [error, cause] => error.starts_with("error: ") && cause.starts_with("  caused by: "),
        [error, .., hint] => error.starts_with("error: ") && hint == "For more information, try '--help'.",
        _ => false,
    };
    assert!(is_good && !said.contains("panicked") && said.len() < 1500, "{args:?} says:\n{said}");
    for word in words {
        assert!(said.contains(word), "{args:?} does not say {word:?}:\n{said}");
    }
}

pub(crate) fn program() -> PathBuf {
    cargo_bin!("umbrae").to_owned()
}

/// A GLB of `document` and the bytes of its first buffer.
pub(crate) fn glb(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let word = |n: usize| u32::try_from(n).expect("a small file").to_le_bytes();
    [b"glTF", &word(2)[..], &word(length), &word(json.len()), b"JSON", &json, &word(binary.len()), b"BIN\0", binary]
        .concat()
}

/// Bytes of 32-bit floats.
pub(crate) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A document with one mesh for each of `offsets` into the buffer, of one triangle of 36 bytes each, and a node for each mesh.
pub(crate) fn triangles_document(offsets: &[usize]) -> Value {
    let all = 0..offsets.len();
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": all.clone().collect::<Vec<_>>() }],
        "nodes": all.clone().map(|i| json!({ "mesh": i })).collect::<Vec<_>>(),
        "meshes": all.clone()
            .map(|i| json!({ "name": format!("mesh {i}"), "primitives": [{ "attributes": { "POSITION": i } }] }))
            .collect::<Vec<_>>(),
        "accessors": all
            .map(|i| json!({ "bufferView": i, "componentType": 5126, "count": 3, "type": "VEC3" }))
            .collect::<Vec<_>>(),
        "bufferViews": offsets
            .iter()
            .map(|&offset| json!({ "buffer": 0, "byteOffset": offset, "byteLength": 36 }))
            .collect::<Vec<_>>(),
        "buffers": [{ "byteLength": 36 * offsets.len() }],
    })
}

/// Adds `item` to a list of a document.
pub(crate) fn push(list: &mut Value, item: Value) {
    list.as_array_mut().expect("a list").push(item);
}

/// A triangle of [`triangles_document`].
pub(crate) const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
