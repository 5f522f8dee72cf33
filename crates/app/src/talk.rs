//! What is said on standard error.

use std::borrow::Cow;
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
        Self { is_quiet, color: color.into() }
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
            self.write(&format!("{}\n", printable(text)));
        }
    }

    /// A bar of `steps` for work that may take long; seen only on a terminal.
    pub fn progress(&self, what: &'static str, steps: u64) -> ProgressBar {
        let target = if self.is_quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let style =
            ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta}").expect("the template is ours and valid");
        let bar = ProgressBar::with_draw_target(Some(steps), target).with_style(style).with_message(what);
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    }

    fn line(&self, style: Style, label: &str, text: &str) {
        self.write(&format!("{style}{label}:{style:#} {}\n", printable(text)));
    }

    fn write(&self, text: &str) {
        let mut stream = AutoStream::new(std::io::stderr(), self.color);
        // If standard error is gone there is nobody left to tell.
        let _ = stream.write_all(text.as_bytes());
    }
}

/// The first of `names`, and how many more there are; at least one.
pub fn and_more(names: &[&str]) -> String {
    match names {
        [one] => format!("`{one}`"),
        _ => format!("`{}` and {} more", names[0], names.len() - 1),
    }
}

/// `1 light`, `2 lights`.
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// `text` on one line, with control characters written out: names in a file may hold any, and a terminal would obey them.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(char::is_control) {
        return Cow::Borrowed(text);
    }
    let escape = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(escape).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_can_not_command_a_terminal() {
        assert_eq!(printable("Größe ❤ \"a\""), "Größe ❤ \"a\"");
        assert_eq!(printable("red \u{1b}[31m\nline\u{9b}2J"), "red \\u{1b}[31m\\nline\\u{9b}2J");
    }
}
