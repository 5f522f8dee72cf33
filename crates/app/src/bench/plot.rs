//! Lines over two logarithmic axes, as SVG.

use std::fmt::Write as _;

/// What is seen of one line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    pub(super) name: String,
    /// Triangles and microseconds, all more than 0, from left to right.
    pub(super) points: Vec<[f64; 2]>,
}

impl Line {
    /// The power with which it grows: the slope of the line that fits its points best, with both axes logarithmic.
    pub(super) fn exponent(&self) -> f64 {
        let logs: Vec<[f64; 2]> = self.points.iter().map(|point| point.map(f64::ln)).collect();
        let mean = |axis: usize| logs.iter().map(|log| log[axis]).sum::<f64>() / logs.len() as f64;
        let [x, y] = [mean(0), mean(1)];
        let along: f64 = logs.iter().map(|log| (log[0] - x) * (log[0] - x)).sum();
        logs.iter().map(|log| (log[0] - x) * (log[1] - y)).sum::<f64>() / along
    }
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 460.0;
/// Around the axes: left, top, right (for the lines' names) and bottom.
const MARGINS: [f64; 4] = [76.0, 44.0, 216.0, 56.0];
/// Okabe and Ito's, which the colour-blind can tell apart.
const COLORS: [&str; 6] = ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"];
/// Names at the ends of lines keep so far apart.
const NAME_HEIGHT: f64 = 19.0;

/// One axis: which decades it shows, and where.
struct Axis {
    decades: [i32; 2],
    ends: [f64; 2],
}

impl Axis {
    fn new(values: impl Iterator<Item = f64> + Clone, ends: [f64; 2]) -> Self {
        let low = values.clone().fold(f64::INFINITY, f64::min).log10().floor();
        let high = values.fold(0.0, f64::max).log10().ceil();
        Self { decades: [low as i32, (high as i32).max(low as i32 + 1)], ends }
    }

    fn at(&self, value: f64) -> f64 {
        let [low, high] = self.decades.map(f64::from);
        self.ends[0] + (value.log10() - low) / (high - low) * (self.ends[1] - self.ends[0])
    }

    fn decades(&self) -> impl Iterator<Item = i32> + use<> {
        self.decades[0]..=self.decades[1]
    }
}

/// A picture of `lines`, each with its name and its exponent.
pub(super) fn svg(lines: &[Line]) -> String {
    let [left, top, right, bottom] = [MARGINS[0], MARGINS[1], WIDTH - MARGINS[2], HEIGHT - MARGINS[3]];
    let values = |axis: usize| lines.iter().flat_map(|line| &line.points).map(move |point| point[axis]);
    let (x, y) = (Axis::new(values(0), [left, right]), Axis::new(values(1), [bottom, top]));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>\n\
         <text x=\"{left}\" y=\"24\" font-size=\"16\">Microseconds to find the silhouette under one light, on one thread</text>\n"
    );
    for decade in x.decades() {
        let at = x.at(10.0_f64.powi(decade));
        // Writing to a string does not fail.
        let _ = writeln!(svg, "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"#d0d0d0\"/>");
        let _ = writeln!(
            svg,
            "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            bottom + 20.0,
            power(decade)
        );
    }
    for decade in y.decades() {
        let at = y.at(10.0_f64.powi(decade));
        let _ = writeln!(svg, "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#d0d0d0\"/>");
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            left - 8.0,
            at + 5.0,
            power(decade)
        );
    }
    let middle = (left + right) / 2.0;
    let _ = writeln!(svg, "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">triangles</text>", HEIGHT - 12.0);

    let names_y = apart(lines.iter().map(|line| line.points.last().map_or(bottom, |point| y.at(point[1]))).collect());
    for (i, (line, name_y)) in lines.iter().zip(names_y).enumerate() {
        let color = COLORS[i % COLORS.len()];
        let places: Vec<[f64; 2]> = line.points.iter().map(|point| [x.at(point[0]), y.at(point[1])]).collect();
        let path: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
        let _ = writeln!(svg, "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>", path.join("L"));
        for [x, y] in &places {
            let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{color}\"/>");
        }
        let exponent = line.exponent();
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{:.1}\" fill=\"{color}\">{}: n<tspan dy=\"-5\" font-size=\"11\">{exponent:.2}</tspan></text>",
            right + 12.0,
            name_y + 5.0,
            line.name
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// 10, 100, 1000 as they are, and larger powers of ten as such.
fn power(decade: i32) -> String {
    if (0..=3).contains(&decade) {
        10_u32.pow(decade as u32).to_string()
    } else {
        format!("10<tspan dy=\"-5\" font-size=\"11\">{decade}</tspan>")
    }
}

/// `heights`, moved so that none is nearer to another than [`NAME_HEIGHT`]; in the same order.
fn apart(heights: Vec<f64>) -> Vec<f64> {
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_unstable_by(|&a, &b| heights[a].total_cmp(&heights[b]));
    let mut moved = heights;
    for pair in 1..order.len() {
        let least = moved[order[pair - 1]] + NAME_HEIGHT;
        moved[order[pair]] = moved[order[pair]].max(least);
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(exponent: f64, factor: f64) -> Line {
        let point = |n: f64| [n, factor * n.powf(exponent)];
        Line { name: format!("line {exponent}"), points: [1e4, 1e5, 1e6].map(point).to_vec() }
    }

    #[test]
    fn the_exponent_of_a_power_is_the_power() {
        for exponent in [0.0, 0.5, 1.0, 1.7] {
            assert!((line(exponent, 3.0).exponent() - exponent).abs() < 1e-9);
        }
    }

    #[test]
    fn a_straight_line_is_straight_and_lines_that_end_together_have_names_apart() {
        let text = svg(&[line(1.0, 1e-3), line(1.0, 1.01e-3), line(0.5, 1.0)]);
        let heights: Vec<f64> = text.lines().filter(|line| line.contains("line ")).map(height).collect();
        assert_eq!(heights.len(), 3);
        for (i, a) in heights.iter().enumerate() {
            assert!(heights[..i].iter().all(|b| (a - b).abs() >= NAME_HEIGHT - 0.1), "{heights:?}");
        }
        let dots: Vec<f64> = text.lines().filter(|line| line.contains("<circle")).take(3).map(dot_height).collect();
        assert!((dots[0] + dots[2] - 2.0 * dots[1]).abs() < 0.2, "{dots:?}");
    }

    fn height(line: &str) -> f64 {
        number_after(line, " y=\"")
    }

    fn dot_height(line: &str) -> f64 {
        number_after(line, " cy=\"")
    }

    fn number_after(line: &str, name: &str) -> f64 {
        let rest = line.split(name).nth(1).expect("it has one");
        rest.split('"').next().expect("it ends").parse().expect("a number")
    }
}
