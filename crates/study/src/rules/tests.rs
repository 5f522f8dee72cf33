//! Rules from files, and evidence just above and just below what they ask for.

use jiff::{SignedDuration, Timestamp};

use super::*;
use crate::{ClockKind, Edge, Interval, LocalTime, Place, SunHours, Zone};

const MINUTE_S: f64 = 60.0;
const HOUR_S: f64 = 3600.0;

/// A rule with nothing special: 2 h on one day, for half of the ground.
const PLAIN: &str = r#"
name = "plain"
title = "Plain"
edition = "first"
source = "here"
status = "made up"
disclaimer = "not legal advice"
receivers = ["ground"]
min_altitude_deg = 5.0

[dates]
days = ["03-21"]
need = "each"

[clock]
kind = "civil"
from = "09:00"
to = "17:00"

[sun]
hours = 2.0

[share]
enough_receivers = 0.5
enough_groups = "all"

[variants.strict]
title = "Plain, strict"
sun = { hours = 3.0 }
"#;

/// [`PLAIN`], with one text replaced by another.
fn changed(from: &str, to: &str) -> String {
    assert_eq!(PLAIN.matches(from).count(), 1, "{from} is there once");
    PLAIN.replace(from, to)
}

fn rule(from: &str, to: &str) -> Rule {
    Rule::parse(&changed(from, to), &[]).expect("a rule")
}

fn plain() -> Rule {
    Rule::parse(PLAIN, &[]).expect("a rule")
}

/// So much sun in one piece, exactly.
fn sun(seconds: f64) -> CountedSun {
    sun_within(seconds, 0.0)
}

fn sun_within(seconds: f64, error_s: f64) -> CountedSun {
    CountedSun { total_s: Bounded::within(seconds, error_s), longest_s: Bounded::within(seconds, error_s) }
}

/// A group of receivers of equal weight, each with its sun of one day.
fn ground(name: &str, sun: Vec<CountedSun>) -> GroupEvidence {
    GroupEvidence {
        name: name.to_owned(),
        kind: ReceiverKind::Ground,
        weights: vec![1.0; sun.len()],
        sun,
        sun_before: None,
    }
}

fn evidence(rule: &Rule, groups: Vec<GroupEvidence>) -> Evidence {
    Evidence { days: rule.needs(2026).dates, groups }
}

fn outcome(rule: &Rule, groups: Vec<GroupEvidence>) -> Outcome {
    rule.judge(&evidence(rule, groups)).outcome
}

#[test]
fn every_preset_says_what_it_is_where_it_is_from_and_that_it_is_no_legal_advice() {
    assert_eq!(Rule::preset_names().count(), 6);
    for name in Rule::preset_names() {
        let rule = Rule::preset(name).expect(name);
        assert_eq!(rule.name, name);
        assert!(rule.disclaimer.contains("not legal advice"), "{name}");
        assert!(rule.source.contains("https://"), "{name}");
        assert!(rule.status.contains("verified"), "{name}");
        assert!(!rule.edition.is_empty() && !rule.title.is_empty(), "{name}");
        assert!(!rule.needs(2026).dates.is_empty(), "{name}");
        for variant in &rule.variants {
            let varied = Rule::preset(&format!("{name}:{variant}")).expect(variant);
            assert_ne!(varied.title, rule.title, "{name}:{variant} says what it is");
        }
    }
}

#[test]
fn presets_ask_for_what_the_research_says_they_do() {
    let preset = |name| Rule::preset(name).expect("a preset");
    let hours = |name| preset(name).sun.total_s.expect("hours") / HOUR_S;
    assert_eq!(["en17037", "en17037:medium", "en17037:high"].map(hours), [1.5, 3.0, 4.0]);
    assert_eq!(["bre209", "tno-light", "tno-strict"].map(hours), [2.0, 2.0, 3.0]);
    assert_eq!(["pl-wt60", "nsw-adg", "nsw-adg:elsewhere"].map(hours), [3.0, 2.0, 3.0]);
    let ends = |name| {
        let dates = preset(name).needs(2028).dates;
        [dates[0], dates[dates.len() - 1]].map(|date| date.to_string())
    };
    assert_eq!(ends("en17037"), ["2028-02-01", "2028-03-21"]);
    assert_eq!(preset("en17037").needs(2028).dates.len(), 29 + 21, "a leap year's February is longer");
    assert_eq!(ends("tno-light"), ["2028-02-19", "2028-10-21"]);
    assert_eq!(ends("tno-strict"), ["2028-01-21", "2028-11-22"]);
    assert_eq!(preset("en17037:germany:high").min_altitude_rad, 11_f64.to_radians());
    assert_eq!(preset("tno-light:the-hague").receivers, [ReceiverKind::Wall, ReceiverKind::Points]);
    let children = preset("pl-wt60:children");
    assert_eq!([children.clock.from.text("sunrise"), children.clock.to.text("sunset")], ["08:00", "16:00"]);
    assert_eq!((children.enough_receivers, children.enough_groups), (Enough::All, Enough::All));
    assert_eq!(preset("bre209").least_ratio, Some(0.8));
    assert!(preset("bre209").needs(2026).uses_before && !preset("en17037").needs(2026).uses_before);
}

#[test]
fn a_file_that_is_wrong_is_refused_in_one_sentence_that_names_the_place() {
    let cases = [
        (
            "hours = 2.0",
            "hour = 2.0",
            "line 21: unknown field `hour`, expected one of `hours`, `contiguous_hours`, `least_span_minutes`",
        ),
        ("edition = \"first\"\n", "", "missing field `edition`"),
        (
            "edition = \"first\"",
            "edition = \" \"",
            "`edition` is empty, but a verdict without it can't be checked; write it",
        ),
        ("hours = 2.0", "hours = -2.0", "`sun.hours` is -2, but it is more than 0 hours of a day and 24 at most"),
        ("hours = 2.0", "hours = nan", "`sun.hours` is NaN, but"),
        ("hours = 2.0", "", "`sun` is empty, but a rule asks for `hours`, for `contiguous_hours`, or for both"),
        ("hours = 2.0", "hours = 2.0\nleast_span_minutes = -1.0", "`sun.least_span_minutes` is -1, but it is from 0"),
        ("[\"03-21\"]", "[\"02-30\"]", "`dates.days` is \"02-30\", but that is in no calendar"),
        ("[\"03-21\"]", "[\"02-29\"]", "`dates.days` is \"02-29\", but that is not in every year; take 02-28 or 03-01"),
        ("[\"03-21\"]", "[\"3-21\"]", "`dates.days` is \"3-21\", but that is not written MM-DD"),
        ("[\"03-21\"]", "[]", "`dates.days` is empty, but a rule has one day at least"),
        (
            "days = [\"03-21\"]",
            "window = \"11-22..01-21\"",
            "`dates.window` is \"11-22..01-21\", but that ends before it begins",
        ),
        ("days = [\"03-21\"]", "window = \"03-21\"", "`dates.window` is \"03-21\", but it is written MM-DD..MM-DD"),
        ("days = [\"03-21\"]", "", "`dates` is without days, but a rule has `days` or a `window`"),
        ("\"each\"", "\"some\"", "`dates.need` is \"some\", but it is \"any\", \"each\" or \"worst\""),
        ("\"civil\"", "\"utc\"", "`clock.kind` is \"utc\", but it is \"civil\""),
        (
            "\"09:00\"",
            "\"9\"",
            "`clock.from` is \"9\", but `9` is no time of day; write hours and minutes from 00:00 to 24:00",
        ),
        ("\"09:00\"", "\"09:00+01:00\"", "`clock.from` is \"09:00+01:00\", but a rule holds in every zone"),
        ("\"09:00\"", "\"sunset\"", "`clock.from` is \"sunset\", but"),
        ("\"17:00\"", "\"24:01\"", "`clock.to` is \"24:01\", but"),
        ("\"17:00\"", "\"09:00\"", "`clock.to` is \"09:00\", but that is not after 09:00"),
        (
            "min_altitude_deg = 5.0",
            "min_altitude_deg = 90.0",
            "`min_altitude_deg` is 90, but the sun is between 0 and 90",
        ),
        ("min_altitude_deg = 5.0", "min_altitude_deg = \"5\"", "line 9: invalid type: string \"5\", expected f64"),
        ("[\"ground\"]", "[\"garden\"]", "`receivers` is \"garden\", but there are ground, window, wall, roof, points"),
        ("[\"ground\"]", "[]", "`receivers` is empty, but something must have the sun"),
        ("= 0.5", "= 50", "`share.enough_receivers` is 50, but it is \"one\", \"all\", or a share above 0 and up to 1"),
        ("= 0.5", "= \"half\"", "`share.enough_receivers` is \"half\", but"),
        ("hours = 3.0", "hours = 25.0", "variant `strict`: `sun.hours` is 25, but"),
        ("hours = 3.0", "minutes = 9", "variant `strict`: unknown field `minutes`"),
        ("[clock]", "[clock", "line 15: "),
    ];
    for (from, to, expected) in cases {
        let error = Rule::parse(&changed(from, to), &[]).expect_err(to).to_string();
        assert!(error.contains(expected), "{to}: {error}");
        assert!(!error.contains('\n'), "{error}");
    }
    let unknown = Rule::preset("en17038").expect_err("no such rule").to_string();
    assert_eq!(
        unknown,
        "there is no rule `en17038`; there are en17037, bre209, tno-light, tno-strict, pl-wt60, nsw-adg, and files of your own"
    );
    let unknown = Rule::preset("en17037:low").expect_err("no such variant").to_string();
    assert_eq!(unknown, "the rule `en17037` has no variant `low`; it has germany, high, medium");
}

#[test]
fn a_variant_changes_what_it_names_and_nothing_else() {
    let strict = Rule::parse(PLAIN, &["strict"]).expect("a variant");
    let expected = Rule {
        title: "Plain, strict".to_owned(),
        sun: SunNeeded { total_s: Some(3.0 * HOUR_S), ..plain().sun },
        ..plain()
    };
    assert_eq!(strict, expected);
}

#[test]
fn clocks_may_follow_the_sun_or_be_sundials() {
    let text = changed("from = \"09:00\"\nto = \"17:00\"", "from = \"sunrise+1h\"\nto = \"sunset-30min\"");
    let clock = Rule::parse(&text.replace("\"civil\"", "\"solar\""), &[]).expect("a rule").clock;
    let [from, to] = [60, -30].map(|minutes| Edge::Sun(SignedDuration::from_mins(minutes)));
    assert_eq!(clock, RuleClock { kind: ClockKind::Solar, from, to });
    assert_eq!(rule("\"17:00\"", "\"24:00\"").clock.to, Edge::Local(LocalTime::END_OF_DAY));
}

#[test]
fn what_a_rule_needs_is_a_period_of_any_zone() {
    let vienna = Place::from_degrees(48.21, 16.37).expect("a place");
    let zone = Zone::of_place(&vienna);
    let needs = Rule::preset("pl-wt60").expect("a preset").needs(2026);
    let period = needs.period(zone, SignedDuration::from_mins(30));
    let timetable = crate::Timetable::new(&vienna, &period, &crate::SunOptions::default()).expect("days");
    assert_eq!((timetable.days.len(), timetable.steps.len()), (2, 2 * 20));
}

#[test]
fn exactly_enough_sun_for_exactly_enough_area_is_met_and_a_second_or_a_cell_less_is_not() {
    let enough = 2.0 * HOUR_S;
    let group = |seconds: f64| vec![ground("garden", vec![sun(seconds), sun(seconds), sun(0.0), sun(0.0)])];
    assert_eq!(outcome(&plain(), group(enough)), Outcome::Met);
    assert_eq!(outcome(&plain(), group(enough - 1.0)), Outcome::NotMet);
    assert_eq!(outcome(&plain(), vec![ground("garden", vec![sun(enough), sun(0.0), sun(0.0)])]), Outcome::NotMet);

    // By area: one large cell is worth two small ones.
    let mut weighted = ground("garden", vec![sun(enough), sun(0.0), sun(0.0)]);
    weighted.weights = vec![2.0, 1.0, 1.0];
    let verdict = plain().judge(&evidence(&plain(), vec![weighted]));
    assert_eq!((verdict.outcome, verdict.groups[0].share.value, verdict.groups[0].margin), (Outcome::Met, 0.5, 0.0));
    let numbers = verdict.groups[0].days[0];
    assert_eq!((numbers.least_sun_s, numbers.mean_sun_s, numbers.most_sun_s), (0.0, HOUR_S, enough));
    assert_eq!(verdict.text, "Plain: met: in garden, 50 % of the receivers (50 % needed) with 2 h of sun a day.");
}

#[test]
fn the_days_may_be_any_each_or_the_worst_one() {
    let with = |need: &str| {
        rule("days = [\"03-21\"]\nneed = \"each\"", &format!("days = [\"03-21\", \"06-21\"]\nneed = \"{need}\""))
    };
    let (yes, no) = (sun(2.0 * HOUR_S), sun(HOUR_S));
    // Two receivers, two days each.
    let group = |sun: [[CountedSun; 2]; 2]| {
        let mut group = ground("garden", sun.concat());
        group.weights = vec![1.0; 2];
        vec![group]
    };
    let outcomes = |sun: [[CountedSun; 2]; 2]| ["any", "each", "worst"].map(|need| outcome(&with(need), group(sun)));
    use Outcome::{Met, NotMet};
    assert_eq!(outcomes([[yes, yes], [no, no]]), [Met, Met, Met]);
    // One of the two has it on each day, but not the same one.
    assert_eq!(outcomes([[yes, no], [no, yes]]), [Met, NotMet, Met]);
    assert_eq!(outcomes([[yes, no], [yes, no]]), [Met, NotMet, NotMet]);
    assert_eq!(outcomes([[no, no], [no, no]]), [NotMet, NotMet, NotMet]);
    let worst = with("worst");
    let verdict = worst.judge(&evidence(&worst, group([[yes, no], [yes, no]])));
    assert_eq!(verdict.groups[0].deciding_day.expect("the worst").0.to_string(), "2026-06-21");
    assert!(verdict.text.contains("0 % of the receivers (50 % needed) on 2026-06-21"), "{}", verdict.text);
}

/// Sun for so many minutes at a time, an hour of shade between.
fn pieces(minutes: &[i64], error_bound_s: f64) -> SunHours {
    let mut at = Timestamp::UNIX_EPOCH;
    let mut interval = |&minutes: &i64| {
        let start = at;
        at += SignedDuration::from_mins(minutes);
        let interval = Interval::new(start, at);
        at += SignedDuration::from_hours(1);
        interval
    };
    SunHours { intervals: minutes.iter().map(&mut interval).collect(), error_bound_s }
}

#[test]
fn sun_in_pieces_counts_in_all_but_not_in_one_piece() {
    let total = plain();
    let in_one = rule("hours = 2.0", "contiguous_hours = 2.0");
    let of =
        |rule: &Rule, minutes: &[i64]| outcome(rule, vec![ground("garden", vec![rule.count(&pieces(minutes, 0.0))])]);
    assert_eq!(of(&total, &[60, 60]), Outcome::Met);
    assert_eq!(of(&in_one, &[60, 60]), Outcome::NotMet);
    assert_eq!(of(&in_one, &[30, 120]), Outcome::Met);
    let both = rule("hours = 2.0", "hours = 3.0\ncontiguous_hours = 2.0");
    assert_eq!(of(&both, &[120]), Outcome::NotMet);
    assert_eq!(of(&both, &[59, 120]), Outcome::NotMet);
    assert_eq!(of(&both, &[60, 120]), Outcome::Met);
    assert_eq!(of(&both, &[90, 90]), Outcome::NotMet);
}

#[test]
fn pieces_that_are_too_short_do_not_count() {
    let rule = rule("hours = 2.0", "hours = 2.0\nleast_span_minutes = 15.0");
    let total = |minutes: &[i64], error_s: f64| rule.count(&pieces(minutes, error_s)).total_s;
    assert_eq!(total(&[15, 14, 105], 0.0), Bounded::exact(120.0 * MINUTE_S));
    assert_eq!(total(&[14, 14, 14], 0.0), Bounded::exact(0.0));
    // Within two minutes, the pieces of 14 and of 15 may count or not.
    let bounded = total(&[15, 14, 105, 12], 2.0 * MINUTE_S);
    assert_eq!([bounded.least, bounded.value, bounded.most].map(|s| s / MINUTE_S), [103.0, 120.0, 136.0]);
    let verdict = rule.judge(&evidence(&rule, vec![ground("garden", vec![rule.count(&pieces(&[15, 105], 0.0))])]));
    assert!(verdict.text.ends_with("with 2 h of sun a day, pieces under 15 min not counted."), "{}", verdict.text);
}

#[test]
fn a_verdict_that_the_error_bound_could_turn_says_so() {
    let enough = 2.0 * HOUR_S;
    let of = |seconds: f64, error_s: f64| outcome(&plain(), vec![ground("garden", vec![sun_within(seconds, error_s)])]);
    assert_eq!(of(enough + 450.0, 450.0), Outcome::Met);
    assert_eq!(of(enough + 449.0, 450.0), Outcome::Undecided { is_met_as_computed: true });
    assert_eq!(of(enough, 1.0), Outcome::Undecided { is_met_as_computed: true });
    assert_eq!(of(enough - 1.0, 450.0), Outcome::Undecided { is_met_as_computed: false });
    assert_eq!(of(enough - 450.0, 450.0), Outcome::Undecided { is_met_as_computed: false });
    assert_eq!(of(enough - 451.0, 450.0), Outcome::NotMet);

    // Receivers that could turn do not matter where they are too few to turn the share.
    let sure = vec![sun(enough), sun(enough), sun_within(enough, 9.0)];
    let verdict = plain().judge(&evidence(&plain(), vec![ground("garden", sure)]));
    assert_eq!(verdict.outcome, Outcome::Met);
    let share = verdict.groups[0].share;
    assert!(share.least < 0.67 && share.value == 1.0 && share.most == 1.0, "{share:?}");
    let text = plain().judge(&evidence(&plain(), vec![ground("garden", vec![sun_within(enough, 1.0)])])).text;
    assert!(text.starts_with("Plain: met as computed, but the error bound of the hours could turn it: "), "{text}");
}

#[test]
fn a_loss_is_noticeable_below_four_fifths_of_what_was_there_before() {
    let bre = Rule::preset("bre209").expect("a preset");
    let lit = |count: usize| -> Vec<CountedSun> {
        (0..100).map(|i| sun(if i < count { 2.0 * HOUR_S } else { 0.0 })).collect()
    };
    let group = |now: usize, before: Option<usize>| {
        vec![GroupEvidence { sun_before: before.map(lit), ..ground("garden", lit(now)) }]
    };
    assert_eq!(outcome(&bre, group(50, None)), Outcome::Met);
    assert_eq!(outcome(&bre, group(49, None)), Outcome::NotMet);
    assert_eq!(outcome(&bre, group(50, Some(100))), Outcome::Met, "half is enough, however much is lost");
    assert_eq!(outcome(&bre, group(32, Some(40))), Outcome::Met, "0.8 is no loss");
    assert_eq!(outcome(&bre, group(31, Some(40))), Outcome::NotMet);
    assert_eq!(outcome(&bre, group(0, Some(0))), Outcome::Met, "nothing is lost where nothing was");
    let verdict = bre.judge(&evidence(&bre, group(30, Some(40))));
    assert!(verdict.groups[0].ratio.is_some_and(|ratio| (ratio - 0.75).abs() < 1e-12), "{verdict:?}");
    assert!(
        verdict
            .text
            .contains("30 % of the receivers (50 % needed), 0.75 times the 40 % before (0.8 needed if too few)"),
        "{}",
        verdict.text
    );
    let unknown = bre.judge(&evidence(&bre, group(49, None))).text;
    assert!(unknown.contains("what it was before is not known"), "{unknown}");

    // Now is short where before is long: the bound of the ratio is that of both.
    let mut close = group(32, Some(40));
    for sun in &mut close[0].sun_before.as_mut().expect("a before")[40..42] {
        *sun = sun_within(2.0 * HOUR_S - 1.0, 5.0);
    }
    assert_eq!(outcome(&bre, close), Outcome::Undecided { is_met_as_computed: true });
}

#[test]
fn seven_flats_of_ten_are_enough_if_not_too_many_have_no_sun_at_all() {
    let nsw = Rule::preset("nsw-adg").expect("a preset");
    // The living room and the balcony of each flat.
    let flats = |good: usize, some: usize, dark: usize| -> Vec<GroupEvidence> {
        let flat = |seconds: f64| GroupEvidence {
            kind: ReceiverKind::Window,
            ..ground("flat", vec![sun(seconds), sun(2.0 * HOUR_S.min(seconds))])
        };
        [(good, 2.0 * HOUR_S), (some, HOUR_S), (dark, 0.0)]
            .iter()
            .flat_map(|&(count, s)| vec![flat(s); count])
            .collect()
    };
    assert_eq!(outcome(&nsw, flats(7, 3, 0)), Outcome::Met);
    assert_eq!(outcome(&nsw, flats(6, 4, 0)), Outcome::NotMet);
    assert_eq!(outcome(&nsw, flats(14, 3, 3)), Outcome::Met, "15 % dark");
    assert_eq!(outcome(&nsw, flats(14, 2, 4)), Outcome::NotMet, "20 % dark");
    let verdict = nsw.judge(&evidence(&nsw, flats(14, 2, 4)));
    assert_eq!((verdict.group_count, verdict.groups_met.value, verdict.groups_without_sun.value), (20, 14.0, 4.0));
    assert!(
        verdict.text.contains("14 of 20 groups (70 % needed)")
            && verdict.text.contains("4 without any sun (15 % allowed)"),
        "{}",
        verdict.text
    );
    // A flat that may be dark could turn it.
    let mut close = flats(14, 3, 3);
    close[14].sun = vec![sun_within(MINUTE_S, 2.0 * MINUTE_S); 2];
    assert_eq!(outcome(&nsw, close), Outcome::Undecided { is_met_as_computed: true });
}

#[test]
fn one_window_of_a_dwelling_on_one_day_is_enough_for_en_17037() {
    let rule = Rule::preset("en17037").expect("a preset");
    let days = rule.needs(2026).dates.len();
    let dwelling = |name: &str, best_s: f64| {
        let mut sun_of_days = vec![sun(HOUR_S); 2 * days];
        sun_of_days[days + 7] = sun(best_s);
        GroupEvidence { kind: ReceiverKind::Window, weights: vec![1.0; 2], ..ground(name, sun_of_days) }
    };
    assert_eq!(outcome(&rule, vec![dwelling("a", 1.5 * HOUR_S)]), Outcome::Met);
    assert_eq!(outcome(&rule, vec![dwelling("a", 1.5 * HOUR_S - 1.0)]), Outcome::NotMet);
    let verdict = rule.judge(&evidence(&rule, vec![dwelling("a", 2.0 * HOUR_S), dwelling("b", HOUR_S)]));
    assert_eq!(verdict.outcome, Outcome::NotMet);
    assert!(
        verdict.text.contains("1 of 2 groups (all needed)") && verdict.text.contains("the least is b"),
        "{}",
        verdict.text
    );
}

#[test]
fn what_a_rule_is_not_about_is_not_judged() {
    let window = GroupEvidence { kind: ReceiverKind::Window, ..ground("window", vec![sun(0.0)]) };
    let verdict = plain().judge(&evidence(&plain(), vec![window.clone()]));
    assert_eq!(verdict.outcome, Outcome::NotApplicable);
    assert_eq!(verdict.text, "Plain: not applicable, as there is no receiver of kind ground.");
    let groups = vec![window, ground("nowhere", vec![]), ground("garden", vec![sun(3.0 * HOUR_S)])];
    let verdict = plain().judge(&evidence(&plain(), groups));
    assert_eq!((verdict.outcome, verdict.group_count), (Outcome::Met, 1));
    let each: Vec<Outcome> = verdict.groups.iter().map(|group| group.outcome).collect();
    assert_eq!(each, [Outcome::NotApplicable, Outcome::NotApplicable, Outcome::Met]);
}

#[test]
fn a_verdict_is_written_with_the_rule_that_it_is_by() {
    let verdict = plain().judge(&evidence(&plain(), vec![ground("garden", vec![sun_within(2.0 * HOUR_S, 1.0)])]));
    let written = toml::Value::try_from(&verdict).expect("plain data").to_string();
    for part in
        ["edition = \"first\"", "from = \"09:00\"", "day = \"2026-03-21\"", "is_met_as_computed = true", "2026-03-21"]
    {
        assert!(written.contains(part), "{part} in {written}");
    }
}

#[test]
fn shares_in_words_are_not_rounded_over_a_threshold() {
    let text = |share: f64| verdict::Percent(share).to_string();
    assert_eq!([0.5, 0.497, 1.0, 0.0].map(text), ["50 %", "49.7 %", "100 %", "0 %"]);
    assert_eq!([0.9999, 0.0001].map(text), ["just under 100 %", "just over 0 %"]);
    let group = |lit: usize| {
        let sun = (0..10_000).map(|i| sun(if i < lit { 2.0 * HOUR_S } else { 0.0 })).collect();
        plain().judge(&evidence(&plain(), vec![ground("garden", sun)])).text
    };
    assert!(group(4998).contains("not met: in garden, just under 50 %"), "{}", group(4998));
    assert!(group(5000).contains("met: in garden, 50 %"), "{}", group(5000));
}
