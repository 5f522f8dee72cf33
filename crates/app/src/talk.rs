//! What is said on standard error.

use std::io::Write as _;
use std::time::Duration;

use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::ColorWhen;

/// Says things on standard error; standard output is for data.
#[derive(Debug, Clone, Copy)]
pub struct Talk {
    is_quiet: bool,
    color: ColorChoice,
}

impl Talk {
    /// `is_quiet` leaves only errors.
    pub fn new(is_quiet: bool, color: ColorWhen) -> Self {
        let color = match color {
            ColorWhen::Auto => ColorChoice::Auto,
            ColorWhen::Always => ColorChoice::Always,
            ColorWhen::Never => ColorChoice::Never,
        };
        Self { is_quiet, color }
    }

    /// The sentence with its causes.
    pub fn error(&self, error: &anyhow::Error) {
        let bold_red = AnsiColor::Red.on_default().bold();
        self.line(bold_red, "error", &error.to_string());
        for cause in error.chain().skip(1) {
            self.line(Style::new(), "  caused by", &cause.to_string());
        }
    }

    /// Something was left out or looks odd.
    pub fn warning(&self, text: &str) {
        if !self.is_quiet {
            self.line(AnsiColor::Yellow.on_default().bold(), "warning", text);
        }
    }

    /// Something worth knowing.
    pub fn note(&self, text: &str) {
        if !self.is_quiet {
            self.write(&format!("{text}\n"));
        }
    }

    /// A bar of `steps` for work that may take long; seen only on a terminal.
    pub fn progress(&self, what: &'static str, steps: u64) -> ProgressBar {
        let target = if self.is_quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta}")
            .expect("the template is ours and valid");
        let bar = ProgressBar::with_draw_target(Some(steps), target).with_style(style).with_message(what);
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    }

    fn line(&self, style: Style, label: &str, text: &str) {
        self.write(&format!("{style}{label}:{style:#} {text}\n"));
    }

    fn write(&self, text: &str) {
        let mut stream = AutoStream::new(std::io::stderr(), self.color);
        // If standard error is gone there is nobody left to tell.
        let _ = stream.write_all(text.as_bytes());
    }
}
