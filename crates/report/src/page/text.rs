//! Text for the page: escaping, and numbers as people read them.
//!
//! Contract: whatever comes in, the result can stand in HTML text and in a quoted
//! attribute, and no "NaN" or "inf" ever reaches the page.

/// Narrow no-break space: parts thousands, and numbers from their units.
const THIN: char = '\u{202f}';

/// What stands where there is no number.
pub const NOTHING: &str = "–";

/// Makes any text safe inside an element or a quoted attribute.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // Control characters are not allowed in HTML, escaped or not.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A model's name, escaped, or that it has none.
pub fn model_name(name: &str) -> String {
    match name.trim() {
        "" => "a model without a name".into(),
        name => escape(name),
    }
}

/// A whole number with its thousands parted.
pub fn count(number: usize) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(THIN);
        }
        out.push(digit);
    }
    out
}

/// `number` with so many decimals and a true minus sign.
pub fn decimal(number: f64, decimals: usize) -> String {
    if !number.is_finite() {
        return NOTHING.into();
    }
    let text = format!("{:.decimals$}", number.abs());
    // Rounding may have left nothing of a small negative number.
    let negative = number < 0.0 && text.chars().any(|c| matches!(c, '1'..='9'));
    if negative { format!("−{text}") } else { text }
}

/// The same with the thousands of its whole part parted.
pub fn grouped(number: f64, decimals: usize) -> String {
    let text = decimal(number, decimals);
    let whole = text.trim_start_matches('−').split('.').next().unwrap_or_default();
    match whole.parse() {
        Ok(digits) => text.replacen(whole, &count(digits), 1),
        Err(_) => text,
    }
}

/// `number` as 1.5×10⁷, its first factor with so many decimals; a factor of 1 is left out.
pub fn scientific(number: f64, decimals: usize) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if !number.is_finite() {
        return NOTHING.into();
    }
    if number == 0.0 {
        return "0".into();
    }
    let text = format!("{number:.decimals$e}").replace('-', "−");
    let Some((factor, power)) = text.split_once('e') else { return text };
    let mut out = match factor {
        "1" => String::from("10"),
        "−1" => String::from("−10"),
        factor => format!("{factor}×10"),
    };
    out.extend(power.chars().map(|c| c.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize])));
    out
}

/// `number` with so many significant figures (whole numbers with all of theirs), and with a
/// power of ten where zeros would have to be counted.
pub fn figures(number: f64, figures: usize) -> String {
    let power = number.abs().log10().floor();
    if number == 0.0 || number.fract() == 0.0 && power < 7.0 {
        grouped(number, 0)
    } else if (-5.0..7.0).contains(&power) {
        grouped(number, (figures as f64 - 1.0 - power).max(0.0) as usize)
    } else {
        scientific(number, figures.saturating_sub(1))
    }
}

/// [`decimal`] with a plus sign where it grows.
pub fn change(number: f64, decimals: usize) -> String {
    let text = decimal(number, decimals);
    if number.is_finite() && text.chars().any(|c| matches!(c, '1'..='9')) && number > 0.0 {
        format!("+{text}")
    } else {
        text
    }
}

/// The class of a change that is shown with so many decimals: better, worse, or none
/// where a reader sees no change.
pub fn verdict(number: f64, decimals: usize, more_is_better: bool) -> &'static str {
    match change(number, decimals).chars().next() {
        Some('+') => {
            if more_is_better {
                "better"
            } else {
                "worse"
            }
        }
        Some('−') => {
            if more_is_better {
                "worse"
            } else {
                "better"
            }
        }
        _ => "",
    }
}

/// `part` of `whole` in percent, as exact as is of interest.
pub fn share(part: usize, whole: usize) -> String {
    let percent = 100.0 * part as f64 / whole.max(1) as f64;
    let text = match part {
        0 => "0".into(),
        _ if percent < 0.1 => "&lt;".to_string() + &format!("{THIN}0.1"),
        _ if percent < 10.0 => decimal(percent, 1),
        _ => decimal(percent, 0),
    };
    format!("{text}{THIN}%")
}

/// Seconds: tenths up to a minute, then minutes and seconds.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() || s < 0.0 => NOTHING.into(),
        s if s < 0.0995 => format!("{:.0}{THIN}ms", s * 1e3),
        s if s < 9.995 => format!("{s:.2}{THIN}s"),
        s if s < 99.95 => format!("{s:.1}{THIN}s"),
        s => {
            let whole = s.round() as u64;
            format!("{}{THIN}min {:02}{THIN}s", whole / 60, whole % 60)
        }
    }
}

/// Bytes in decimal megabytes or gigabytes.
pub fn bytes(bytes: u64) -> String {
    let mega = bytes as f64 / 1e6;
    if mega < 999.5 { format!("{mega:.0}{THIN}MB") } else { format!("{:.2}{THIN}GB", mega / 1e3) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the page from names that look like HTML.
    #[test]
    fn names_cannot_break_out() {
        assert_eq!(escape(r#"<a href="x">'&'</a>"#), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
        assert_eq!(escape("a\u{0}b\nc"), "a b c");
        assert_eq!(escape("Bröd — 面包"), "Bröd — 面包");
    }

    /// Protects the numbers' look at their borders.
    #[test]
    fn numbers() {
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(decimal(f64::NAN, 2), "–");
        assert_eq!(decimal(-0.001, 2), "0.00");
        assert_eq!(decimal(-1.5, 1), "−1.5");
        assert_eq!(change(2.0, 1), "+2.0");
        assert_eq!(change(-2.0, 1), "−2.0");
        assert_eq!(change(0.001, 1), "0.0");
        assert_eq!(change(f64::INFINITY, 1), "–");
        assert_eq!(["better", "worse", ""], [0.006, -0.006, 0.004].map(|x| verdict(x, 2, true)));
        assert_eq!(["worse", "better", ""], [1.0, -1.0, f64::NAN].map(|x| verdict(x, 0, false)));
        assert_eq!(share(0, 0), "0\u{202f}%");
        assert_eq!(share(1, 1_000_000), "&lt;\u{202f}0.1\u{202f}%");
        assert_eq!(share(1, 3), "33\u{202f}%");
        assert_eq!(duration(0.0123), "12\u{202f}ms");
        assert_eq!(duration(125.2), "2\u{202f}min 05\u{202f}s");
        assert_eq!(duration(f64::NAN), "–");
        assert_eq!(bytes(457_000_000), "457\u{202f}MB");
    }

    /// Protects a chart's numbers, which may have any magnitude.
    #[test]
    fn numbers_of_any_magnitude() {
        assert_eq!(grouped(-12_345.67, 1), "−12\u{202f}345.7");
        assert_eq!(grouped(999.96, 1), "1\u{202f}000.0");
        assert_eq!(grouped(f64::NAN, 1), "–");
        assert_eq!(scientific(0.000_012, 1), "1.2×10⁻⁵");
        assert_eq!(scientific(-1e12, 0), "−10¹²");
        assert_eq!(scientific(9.99e7, 0), "10⁸");
        assert_eq!(scientific(0.0, 2), "0");
        assert_eq!(scientific(f64::NEG_INFINITY, 2), "–");
        let all = [0.0, 3.0, 30_000.0, 31.2345, -0.012_345, 1.2346e-9, 1e300, f64::INFINITY];
        let texts = ["0", "3", "30\u{202f}000", "31.23", "−0.01235", "1.235×10⁻⁹", "1.000×10³⁰⁰", "–"];
        assert_eq!(all.map(|number| figures(number, 4)), texts);
    }
}
