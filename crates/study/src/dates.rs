//! Days of the calendar, as people write them.

use jiff::ToSpan as _;
use jiff::civil::Date;

use crate::TimeError;

/// `2026-09-18` into a date.
///
/// # Errors
///
/// [`TimeError::Date`] if it is not written as year, month and day, or there is no such day.
pub fn parse_date(text: &str) -> Result<Date, TimeError> {
    let wrong = |reason: String| TimeError::Date { text: text.to_owned(), reason };
    let parts: Vec<&str> = text.trim().split('-').collect();
    let [year, month, day] = parts[..] else {
        return Err(wrong("write year, month and day, such as 2026-09-18".to_owned()));
    };
    let number = |text: &str, digits: usize| {
        let is_number = text.len() == digits && text.bytes().all(|byte| byte.is_ascii_digit());
        is_number.then(|| text.parse::<i16>().ok()).flatten()
    };
    let (Some(year), Some(month), Some(day)) = (number(year, 4), number(month, 2), number(day, 2)) else {
        return Err(wrong("write year, month and day, such as 2026-09-18".to_owned()));
    };
    if !(1..=12).contains(&month) {
        return Err(wrong(format!("a year has months 01 to 12, not {month:02}")));
    }
    let first = Date::new(year, month as i8, 1).map_err(|error| wrong(error.to_string()))?;
    let last = first.days_in_month();
    let is_day = (1..=i16::from(last)).contains(&day);
    let date = is_day.then(|| Date::new(year, month as i8, day as i8).ok()).flatten();
    date.ok_or_else(|| wrong(format!("{} has days 01 to {last}", first.strftime("%B %Y"))))
}

/// `2026-02-01..2026-03-21` into every day from the first to the last, both included; a single date into itself.
///
/// # Errors
///
/// As [`parse_date`], and [`TimeError::DatesReversed`].
///
/// # Example
///
/// ```
/// assert_eq!(umbrae_study::parse_dates("2028-02-01..2028-03-01")?.len(), 30);
/// # Ok::<(), umbrae_study::TimeError>(())
/// ```
pub fn parse_dates(text: &str) -> Result<Vec<Date>, TimeError> {
    let Some((first, last)) = text.split_once("..") else {
        return Ok(vec![parse_date(text)?]);
    };
    let (first, last) = (parse_date(first)?, parse_date(last)?);
    if last < first {
        return Err(TimeError::DatesReversed { first, last });
    }
    Ok(first.series(1.day()).take_while(|date| *date <= last).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_that_the_calendar_lacks_are_refused_with_those_it_has() {
        let refusal = |text: &str| parse_date(text).expect_err(text).to_string();
        assert_eq!(refusal("2026-02-30"), "`2026-02-30` is no date: February 2026 has days 01 to 28");
        assert_eq!(refusal("2028-02-30"), "`2028-02-30` is no date: February 2028 has days 01 to 29");
        assert_eq!(refusal("2026-13-01"), "`2026-13-01` is no date: a year has months 01 to 12, not 13");
        for bad in ["", "2026", "18.9.2026", "2026-9-18", "26-09-18", "2026-09-18T12:00", "2026-09-", "2026-00-01"] {
            assert!(parse_date(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_range_has_both_its_ends() {
        let days = parse_dates("2026-02-27..2026-03-02").expect("a range");
        let days: Vec<String> = days.iter().map(ToString::to_string).collect();
        assert_eq!(days, ["2026-02-27", "2026-02-28", "2026-03-01", "2026-03-02"]);
        assert_eq!(parse_dates("2026-02-27..2026-02-27").expect("a day").len(), 1);
        assert_eq!(parse_dates("0001-01-01..9999-12-31").expect("the calendar").len(), 3_652_059);
        let error = parse_dates("2026-03-02..2026-02-27").expect_err("reversed").to_string();
        assert!(error.contains("write the earlier one first"), "{error}");
    }
}
