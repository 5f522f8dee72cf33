//! `umbrae study`: models, a place and a period into hours of sun, shadow profiles and a report. Needs no graphics driver.
//!
//! [`run`] is the table of contents. Blocks of receivers go through the engine one after the other ([`tiles`]), their bits and
//! sums into files; everything else is written from those ([`results`], [`write`]).

mod cancel;
mod folder;
mod frame;
mod inputs;
mod moments;
mod points;
mod receivers;
mod results;
mod rows;
mod scene;
mod site;
mod sums;
mod tiles;
mod write;

use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context as _, bail, ensure};
use glam::DVec3;
use umbrae_study::{Packets, Receivers};
use web_time::Instant;

use self::folder::Folder;
use self::frame::Frame;
use self::inputs::{inputs, key, options};
use self::receivers::receivers;
use self::results::{Results, State, Timings};
use self::scene::{Models, Situation};
use self::tiles::{Job, Workshop};
use crate::cli::StudyArgs;
use crate::show::numbers::{counted, grouped};
use crate::talk::Talk;

/// How a study ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// It is done.
    Whole,
    /// It is done, and rays found errors in it.
    Disagreed,
    /// It was stopped, and what was finished is written.
    Stopped,
}

/// Studies what `args` ask for and writes the results.
///
/// # Errors
///
/// Whatever is wrong with the input or the folder; then no result is written.
pub fn run(args: &StudyArgs, talk: &Talk) -> anyhow::Result<Ending> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(args.threads.map_or(0, Into::into)).build();
    threads.context("can't start threads")?.install(|| study(args, talk))
}

fn study(args: &StudyArgs, talk: &Talk) -> anyhow::Result<Ending> {
    let begin = Instant::now();
    let mut timings = Timings::default();
    let mut folder = Folder::make_sure(&args.output)?;

    let models = Models::load(args, talk)?;
    let frame = Frame { origin: models.scene.origin, crs: models.crs.clone() };
    let (site, timetable, said) = moments::moments(args, &models, &frame)?;
    let north_rad = site.north_deg.to_radians();
    let suns: Vec<Option<DVec3>> =
        timetable.steps.iter().map(|step| step.is_day.then(|| step.sun.direction(north_rad))).collect();
    timings.load_s = seconds_since(begin);

    let start = Instant::now();
    let situations = models.situations();
    let (receivers, chosen) = receivers(args, &models, &situations, &suns)?;
    let inside = insides(&situations, &receivers);
    timings.prepare_s = seconds_since(start);

    let mut results = Results {
        subject: subject(args),
        site,
        frame,
        timetable,
        suns,
        receivers,
        states: Vec::new(),
        check: None,
        is_partial: false,
        timings,
        inputs: inputs(args)?,
        options: options(args),
        warnings: models.warnings.clone(),
        models,
    };
    results.warnings.extend(said);
    if results.day_steps() == 0 {
        results
            .warnings
            .push("the sun does not count at any step: it is below the horizon or the least altitude".to_owned());
    }
    results.warnings.iter().for_each(|warning| talk.warning(warning));
    chosen.iter().for_each(|sentence| talk.note(sentence));
    talk.note(&introduction(&results));

    let stop = cancel::when_interrupted()?;
    folder.create()?;
    let mut workshop = Workshop::open(&args.output, &key(&results, &inside), args.resume)?;
    if args.resume && !workshop.has_finished_blocks() {
        talk.note("there is nothing to resume, so the study begins anew");
    }
    compute(&mut results, &situations, inside, &mut workshop, &stop, talk)?;
    if results.states.iter().all(|state| state.sums.iter().all(Option::is_none)) && results.is_partial {
        bail!("the study was stopped before anything of it was finished");
    }

    let start = Instant::now();
    write::write_all(&results, &mut folder, talk)?;
    results.timings.write_s = seconds_since(start);
    results.timings.total_s = seconds_since(begin);
    write::write_run(&results, &mut folder)?;
    folder.publish()?;
    if results.is_partial {
        talk.warning(&format!("stopped: what is finished is in `{}`; --resume continues", args.output.display()));
        return Ok(Ending::Stopped);
    }
    workshop.remove()?;
    talk.note(&summary(&results, args));
    let is_right = results.check.is_none_or(|check| check.disagreements == 0);
    Ok(if is_right { Ending::Whole } else { Ending::Disagreed })
}

/// For each situation, which receivers are inside of its solids.
fn insides(situations: &[Situation], receivers: &Receivers) -> Vec<Vec<bool>> {
    let of = |situation: &Situation| situation.solids.hold(&receivers.positions);
    match situations {
        // The receivers know that themselves.
        [_] => vec![receivers.is_inside.clone()],
        several => several.iter().map(of).collect(),
    }
}

/// Computes every state into `results`, or what can be done until `stop` is set.
fn compute(
    results: &mut Results,
    situations: &[Situation],
    inside: Vec<Vec<bool>>,
    workshop: &mut Workshop,
    stop: &AtomicBool,
    talk: &Talk,
) -> anyhow::Result<()> {
    let of_state: Vec<Receivers> =
        inside.into_iter().map(|is_inside| Receivers { is_inside, ..results.receivers.clone() }).collect();
    let packets: Vec<Packets> = of_state.iter().map(Packets::new).collect();
    let bar = talk.progress("sun and shadow", packets.iter().map(|packets| packets.len() as u64).sum());
    for (state, situation) in situations.iter().enumerate() {
        let job = Job {
            state,
            blockers: &situation.blockers,
            receivers: &of_state[state],
            packets: &packets[state],
            steps: &results.timetable.steps,
            suns: &results.suns,
        };
        let computed = workshop.compute(job, stop, |packets| bar.inc(packets))?;
        results.timings.engine_s += computed.engine_s;
        results.is_partial |= !computed.is_whole;
        results.states.push(State {
            name: situation.name,
            objects: situation.objects.clone(),
            is_inside: of_state[state].is_inside.clone(),
            sums: computed.sums,
            rows: computed.rows,
        });
    }
    bar.finish_and_clear();
    ensure!(!stop.load(Ordering::Relaxed) || results.is_partial || !results.states.is_empty(), "stopped");
    Ok(())
}

/// What the study is of: the names of its models.
fn subject(args: &StudyArgs) -> String {
    let paths = args.models.iter().chain(&args.existing).chain(&args.proposed);
    paths.map(|path| scene::file_name(path)).collect::<Vec<_>>().join(", ")
}

fn introduction(results: &Results) -> String {
    format!(
        "{}: {}; {} in {}, {} at {}",
        results.subject,
        results.period_text(),
        counted(results.models.scene.triangle_count(), "triangle"),
        counted(results.models.casters.len(), "object"),
        counted(results.receivers.len(), "receiver"),
        counted(results.day_steps(), "step")
    )
}

fn summary(results: &Results, args: &StudyArgs) -> String {
    let verdicts = results.day_steps() as u64 * results.states.iter().flat_map(|s| &s.sums).flatten().count() as u64;
    format!(
        "{} verdicts in {:.2} s, everything in {:.1} s; open `{}`",
        grouped(verdicts),
        results.timings.engine_s,
        results.timings.total_s,
        args.output.join("report.html").display()
    )
}

fn seconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64()
}
