//! `umbrae study`: models, a place and a period into hours of sun, shadow profiles and a report. Needs no graphics driver.
//!
//! [`run`] is the table of contents. Blocks of receivers go through the engine one after the other (`tiles`), their bits and
//! sums into files; everything else is written from those (`results`, `write`).

mod block;
mod cancel;
mod check;
mod folder;
mod fractions;
mod frame;
mod inputs;
mod judge;
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

use std::sync::atomic::AtomicBool;

use anyhow::Context as _;
use umbrae_study::rules::Rule;
use umbrae_study::{Packets, Receivers, Refinement};
use web_time::Instant;

use self::folder::Folder;
use self::frame::Frame;
use self::inputs::{inputs, key, options};
use self::receivers::receivers;
use self::results::{Check, Disc, Results, State, Timings};
use self::scene::{Models, Situation};
use self::tiles::{Job, Workshop};
use self::write::Wants;
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
    let rules = judge::rules(&args.rules)?;

    let models = Models::load(args, talk)?;
    let frame = Frame { origin: models.scene.origin, crs: models.crs.clone() };
    let (site, timetable, said) = moments::moments(args, &models, &frame)?;
    let north_rad = site.north_deg.to_radians();
    let refinement =
        if args.refine { Some(Refinement::new(&site.place, &timetable, &site.options, north_rad)?) } else { None };
    let suns = timetable.directions(north_rad);
    let disc = args.sun_disc.then(|| Disc::new(&timetable, refinement.as_ref(), &site.options, north_rad));
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
        disc,
        receivers,
        states: Vec::new(),
        check: None,
        refinement,
        margin_m: situations.iter().map(|situation| situation.blockers.margin_m()).fold(0.0, f64::max),
        is_partial: false,
        verdicts: Vec::new(),
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
    let of_state: Vec<Receivers> =
        inside.into_iter().map(|is_inside| Receivers { is_inside, ..results.receivers.clone() }).collect();
    compute(&mut results, &situations, &of_state, &mut workshop, &stop, talk)?;
    let is_empty = results.states.iter().all(|state| state.sums.iter().all(Option::is_none));
    if results.is_partial && is_empty {
        talk.warning("stopped before anything was finished, so there is no result");
        return Ok(Ending::Stopped);
    }
    check_sample(&mut results, args.check, &situations, talk)?;
    judge_all(&mut results, &rules, &situations, &of_state, &stop, talk)?;

    let start = Instant::now();
    let wants = Wants { by_object: args.by_object, perspective: !args.no_perspective };
    let shown = write::write_all(&mut results, wants, &mut folder, &stop, talk)?;
    results.timings.write_s = seconds_since(start);
    results.timings.total_s = seconds_since(begin);
    write::write_report(&results, &shown, &mut folder)?;
    folder.publish()?;
    if results.is_partial {
        talk.warning(&format!("stopped: what is finished is in `{}`; --resume continues", args.output.display()));
        return Ok(Ending::Stopped);
    }
    workshop.remove()?;
    talk.note(&summary(&results, args));
    let is_right = results.check.is_none_or(Check::is_right);
    Ok(if is_right { Ending::Whole } else { Ending::Disagreed })
}

/// For each situation, which receivers are inside of its solids.
fn insides(situations: &[Situation], receivers: &Receivers) -> Vec<Vec<bool>> {
    let of = |situation: &Situation| receivers.inside_of(&situation.solids);
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
    of_state: &[Receivers],
    workshop: &mut Workshop,
    stop: &AtomicBool,
    talk: &Talk,
) -> anyhow::Result<()> {
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
            refinement: results.refinement.as_ref(),
            disc: results.disc.as_ref(),
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
            fractions: computed.fractions,
        });
    }
    bar.finish_and_clear();
    Ok(())
}

/// Looks again at a sample of every state, and says what came of it.
fn check_sample(results: &mut Results, sample: usize, situations: &[Situation], talk: &Talk) -> anyhow::Result<()> {
    if sample == 0 {
        return Ok(());
    }
    let start = Instant::now();
    let mut total = Check::default();
    for (state, situation) in results.states.iter().zip(situations) {
        total = total.plus(check::check(sample, state, situation, &results.receivers, &results.suns)?);
        if let (Some(disc), Some(fractions)) = (&results.disc, &state.fractions) {
            let of_disc = check::check_disc(sample, state, fractions, situation, &results.receivers, &disc.suns)?;
            total.disc = Some(total.disc.unwrap_or_default().plus(of_disc));
        }
    }
    results.timings.check_s = seconds_since(start);
    results.check = Some(total);
    let Check { verdicts, disagreements, undecided, .. } = total;
    let counts = [verdicts, disagreements, undecided].map(grouped);
    talk.note(&format!(
        "check: {1} of {0} verdicts differ from those of rays ({2} more at edges of shadows)",
        counts[0], counts[1], counts[2]
    ));
    if let Some(disc) = total.disc {
        talk.note(&format!(
            "check: {} of {} shares of the sun's disc, of which {} see part, differ from what rays to it find ({} more at edges of shadows)",
            grouped(disc.disagreements),
            grouped(disc.shares),
            grouped(disc.partial),
            grouped(disc.undecided)
        ));
    }
    Ok(())
}

/// Judges by every rule, and says the verdicts; stops where `stop` is set.
fn judge_all(
    results: &mut Results,
    rules: &[Rule],
    situations: &[Situation],
    of_state: &[Receivers],
    stop: &AtomicBool,
    talk: &Talk,
) -> anyhow::Result<()> {
    let start = Instant::now();
    for rule in rules {
        let Some(verdict) = judge::judge(rule, results, situations, of_state, stop)? else {
            results.is_partial = true;
            break;
        };
        talk.note(&verdict.text);
        results.verdicts.push(verdict);
    }
    results.timings.rules_s = seconds_since(start);
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
