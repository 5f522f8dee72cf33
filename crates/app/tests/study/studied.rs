//! A study that was done, and its files.

use std::fs::{self, File};
use std::io::Read as _;
use std::path::PathBuf;

use serde_json::Value;

use crate::files::Place;

/// Place and period of most tests: Vienna, 18 September, 9 to 17 h, 32 steps.
pub(crate) const WHEN: &str =
    "--lat 48.2 --lon 16.37 --date 2026-09-18 --from 09:00 --to 17:00 --no-perspective --threads 2";

/// A slab 40 m wide, 2 m thick and 20 m high, from west to east, that stands on the ground in the middle; OBJ with y up.
pub(crate) const SLAB: &str = "\
v -20 0 -1\nv 20 0 -1\nv 20 0 1\nv -20 0 1\nv -20 20 -1\nv 20 20 -1\nv 20 20 1\nv -20 20 1
f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";

/// The folder `out/NAME` of a place.
pub(crate) struct Studied {
    folder: PathBuf,
}

/// A row of `receivers.csv`.
#[derive(Debug, Clone)]
pub(crate) struct Row(csv::StringRecord, csv::StringRecord);

impl Row {
    pub(crate) fn text(&self, column: &str) -> &str {
        let at = self.0.iter().position(|name| name == column);
        &self.1[at.unwrap_or_else(|| panic!("there is a column {column}"))]
    }

    /// NaN where it is empty.
    pub(crate) fn number(&self, column: &str) -> f64 {
        let text = self.text(column);
        if text.is_empty() { f64::NAN } else { text.parse().expect("a number") }
    }
}

impl Studied {
    /// Studies with the words of `args` into `out/name`.
    pub(crate) fn new(place: &Place, name: &str, args: &str) -> Self {
        let output = place.out(name);
        let args: Vec<&str> = ["study", "-o", &output].into_iter().chain(args.split(' ')).collect();
        place.umbrae(&args).success();
        Self::there(place, name)
    }

    /// What is there already.
    pub(crate) fn there(place: &Place, name: &str) -> Self {
        Self { folder: place.out(name).into() }
    }

    pub(crate) fn path(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    pub(crate) fn bytes(&self, file: &str) -> Vec<u8> {
        fs::read(self.path(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
    }

    pub(crate) fn text(&self, file: &str) -> String {
        String::from_utf8(self.bytes(file)).expect("text")
    }

    pub(crate) fn json(&self, file: &str) -> Value {
        serde_json::from_slice(&self.bytes(file)).expect("JSON")
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.folder).expect("the folder is there");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    pub(crate) fn rows(&self) -> Vec<Row> {
        let mut reader = csv::Reader::from_path(self.path("receivers.csv")).expect("a table");
        let header = reader.headers().expect("a header").clone();
        reader.records().map(|record| Row(header.clone(), record.expect("a row"))).collect()
    }

    /// Width, height and values of a TIFF.
    pub(crate) fn tif(&self, file: &str) -> (usize, usize, Vec<f32>) {
        let mut decoder = self.decoder(file);
        let (width, height) = decoder.dimensions().expect("it has a size");
        let tiff::decoder::DecodingResult::F32(values) = decoder.read_image().expect("an image") else {
            panic!("{file} has 32-bit floats");
        };
        (width as usize, height as usize, values)
    }

    pub(crate) fn decoder(&self, file: &str) -> tiff::decoder::Decoder<File> {
        tiff::decoder::Decoder::new(File::open(self.path(file)).expect("it was written")).expect("a TIFF")
    }

    /// An array of `bits.npz`, with its shape.
    pub(crate) fn array<T: npyz::Deserialize>(&self, file: &str, name: &str) -> (Vec<u64>, Vec<T>) {
        let mut archive = zip::ZipArchive::new(File::open(self.path(file)).expect("it was written")).expect("a zip");
        let mut bytes = Vec::new();
        archive.by_name(&format!("{name}.npy")).expect("it is there").read_to_end(&mut bytes).expect("it can be read");
        let array = npyz::NpyFile::new(&bytes[..]).expect("an array");
        let shape = array.shape().to_vec();
        (shape, array.into_vec().expect("values of that type"))
    }
}
