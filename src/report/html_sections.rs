//! The sections of `report.html`: tables of what was tested, found, predicted, and where it came from.

use super::grid::STANDARD_GRAVITY_M_S2;
use super::prediction::{KEPT_SENTENCE, contact_words, kept_mark};
use super::rounding::{
    MISSING, fixed, interval, optional, optional_fixed, parts, percent, plain, significant,
};
use super::settings;
use super::table::{FIRST_IMPACT_CODES, SLAP_DOWN_CODES, end_axis};
use super::text::{
    code_word, format_word, printable, reason, sentence, severity_word, span_text, true_minus,
};
use crate::data::{CaskFile, DropResult, Estimate, FlightRegime, Issue, IssueCode, ModelCandidate};
use maud::{Markup, html};

/// The cask, the drop and the contact; what is a default is marked.
pub(super) fn tested(file: &CaskFile, heading: &str) -> Markup {
    let (cask, drop) = (&file.cask, &file.drop);
    let row = |name: &str, key: &str, value: String, unit: &str| {
        html! {
            tr { th scope="row" { (name) @if file.defaults.iter().any(|d| d == key) { " " span class="default" { "default" } } }
                td class="n" { (value) } td class="u" { (unit) } }
        }
    };
    let section = if cask.height_m > 0.0 { plain(cask.height_m, 5) } else { "thin rod".into() };
    html! {
        h2 { (heading) }
        div class="pair" {
            table class="whole" {
                caption { "Cask " (printable(&cask.name)) }
                tbody {
                    (row("Mass", "cask.mass_kg", plain(cask.mass_kg, 6), "kg"))
                    (row("Length between the ends that strike", "cask.length_m", plain(cask.length_m, 6), "m"))
                    (row("Section in the plane of the drop", "cask.height_m", section, if cask.height_m > 0.0 { "m" } else { "" }))
                    @if let Some(width_m) = cask.width_m { (row("Section across that plane", "cask.width_m", plain(width_m, 6), "m")) }
                    (row("Centre of gravity from the first end", "cask.cog_m", plain(cask.cog_m, 6), "m"))
                    (row("Inertia about the centre of gravity", "cask.inertia_kg_m2", plain(cask.inertia_kg_m2, 6), "kg m²"))
                }
            }
            table class="whole" {
                caption { "Drop and contact" }
                tbody {
                    (row("Free-fall height", "drop.height_m", plain(drop.height_m, 6), "m"))
                    (row("Inclination of the axis", "drop.angle_deg", plain(drop.angle_rad.to_degrees(), 6), "°"))
                    (row(if drop.impact_velocity_given { "Impact velocity, as stated" } else { "Impact velocity, √(2 g h)" },
                        "drop.impact_velocity", plain(drop.impact_velocity_m_s, 5), "m/s"))
                    (row("Gravity", "drop.gravity_m_s2", plain(drop.gravity_m_s2, 6), "m/s²"))
                    (row("Contact of the first end", "contact.friction", contact_words(file.contact), ""))
                }
            }
        }
    }
}

/// First impact, slap-down and k, each with its interval or with the reason why it is missing.
pub(super) fn quantities(result: &DropResult) -> Markup {
    let (first, second) = (&result.first_impact, &result.slap_down);
    html! {
        h2 { "Results" }
        div class="pair" {
            (estimates(result, "First impact", &[
                ("First contact", &first.time),
                ("Impact velocity", &first.impact_velocity),
                ("Duration of the contact", &first.duration),
                ("Rebound velocity, vertical", &first.rebound_velocity),
                ("Angular velocity after it", &first.angular_velocity),
                ("Coefficient of restitution k", &result.k),
            ], &FIRST_IMPACT_CODES))
            (estimates(result, "Slap-down of the second end", &[
                ("Speed before it strikes", &second.speed),
                ("Vertical velocity, up positive", &second.vertical_velocity),
                ("Horizontal velocity", &second.horizontal_velocity),
                ("Inclination of the axis", &second.angle),
                ("Flight from separation", &second.flight_time),
                ("First contact of the second end", &second.time),
            ], &SLAP_DOWN_CODES))
        }
    }
}

fn estimates(
    result: &DropResult,
    title: &str,
    rows: &[(&str, &Option<Estimate>)],
    codes: &[IssueCode],
) -> Markup {
    let missing = rows.iter().any(|(_, estimate)| parts(estimate.as_ref()).is_none());
    html! {
        div class="whole" {
            table {
                caption { (title) }
                thead { tr { th { "Quantity" } th class="n" { "Value" } th class="n" { "± 95 %" } th { "Unit" } } }
                tbody {
                    @for (name, estimate) in rows {
                        tr { th scope="row" { (name) }
                            @match parts(estimate.as_ref()) {
                                Some((value, u95, unit)) => { td class="n" { (value) } td class="n" { (u95) } td class="u" { (unit) } },
                                None => { td class="n" { (MISSING) } td {} td {} },
                            }
                        }
                    }
                }
            }
            @if missing { p class="note" { (MISSING) " could not be had: " (printable(reason(result, codes))) } }
        }
    }
}

/// Every finding.
pub(super) fn findings(result: &DropResult) -> Markup {
    html! {
        h2 { "Quality" }
        @if result.quality.is_empty() {
            p { "No check found anything to say." }
        } @else {
            table {
                thead { tr { th { "Severity" } th { "Check" } th { "Channel" } th { "When" } th { "Finding" } } }
                tbody { @for issue in &result.quality { (finding(issue)) } }
            }
        }
    }
}

fn finding(issue: &Issue) -> Markup {
    let word = severity_word(issue.severity);
    html! {
        tr {
            td class=(format!("tag {word}")) { (word) }
            td class="code" { code { (code_word(issue.code)) } }
            td { (printable(issue.channel.as_deref().unwrap_or(MISSING))) }
            td class="u" { (span_text(issue).unwrap_or_else(|| MISSING.into())) }
            td { (printable(&issue.message)) }
        }
    }
}

/// The model taken, why, and all that were held against the measurement.
pub(super) fn models(result: &DropResult) -> Markup {
    html! {
        h2 { "Model" }
        @match &result.model {
            None => p { "No model was taken: " (printable(reason(result, &SLAP_DOWN_CODES))) },
            Some(model) => {
                p class="lead" { "Taken: " strong { (model.rung.words()) } ". " (sentence(&model.reason)) }
                table class="whole" {
                    caption { "The ladder of analytical models with the measured k, the simplest first; rungs that change nothing are left out" }
                    thead { tr { th { "Model" } th class="n" { "Predicted, m/s" } th class="n" { "± 95 %, m/s" }
                        th class="n" { "Measured against predicted" } th { "Within both intervals" } } }
                    tbody { @for c in &model.candidates { (candidate(c, c.rung == model.rung)) } }
                }
            }
        }
    }
}

fn candidate(c: &ModelCandidate, chosen: bool) -> Markup {
    html! {
        tr class=[chosen.then_some("chosen")] {
            th scope="row" { (c.rung.words()) @if chosen { " (taken)" } }
            td class="n" { (optional_fixed(c.predicted, 2)) }
            td class="n" { (optional(c.u95, 2)) }
            td class="n" { (c.difference_percent.map_or_else(|| MISSING.into(), percent)) }
            td { @if c.consistent { "yes" } @else { "no" } }
        }
    }
}

/// What the analytical models say.
pub(super) fn predictions(result: &DropResult) -> Markup {
    html! {
        @if !result.predictions.is_empty() {
            h2 { "Predictions" }
            table {
                caption { "Rigid-body models at the angle of the drop. Energy: kinetic, before the slap-down over before the first impact." }
                thead { tr {
                    th { "Model" } th { "Contact" } th class="n" { "k" } th class="n" { "Speed, m/s" } th class="n" { "Vertical, m/s" }
                    th class="n" { "Horizontal, m/s" } th class="n" { "ω, rad/s" } th class="n" { "Flight, ms" }
                    th class="n" { "Angle, °" } th class="n" { "Energy" } th class="n" { "Impacts of the first end" }
                } }
                tbody { @for p in &result.predictions { tr {
                    td { (p.model.as_str()) } td { (contact_words(p.contact)) (kept_mark(p.regime)) } td class="n" { (plain(p.k, 3)) }
                    td class="n" { (optional_fixed(p.slap_down_speed_m_s, 2)) }
                    td class="n" { (optional_fixed(p.vertical_velocity_m_s, 2)) }
                    td class="n" { (optional_fixed(p.horizontal_velocity_m_s, 2)) }
                    td class="n" { (fixed(p.angular_velocity_rad_s, 2)) }
                    td class="n" { (optional_fixed(p.flight_time_s.map(|t| t * 1e3), 1)) }
                    td class="n" { (optional_fixed(p.slap_down_angle_deg, 1)) }
                    td class="n" { (optional_fixed(p.energy_ratio, 3)) }
                    td class="n" { (p.first_end_impacts) }
                } } }
            }
            @if result.predictions.iter().any(|p| p.regime == FlightRegime::Contact) { p class="note" { (KEPT_SENTENCE) } }
        }
    }
}

/// The fit of the free-flight window: plateaus, modes, candidates.
pub(super) fn flight(result: &DropResult) -> Markup {
    let Some(fit) = &result.flight else { return html! {} };
    let is_lowest = fit.candidates.first().is_none_or(|c| c.taken);
    html! {
        h2 { "Fit of the flight" }
        p class="lead" { "From " (fixed(fit.from_s * 1e3, 2)) " to " (fixed(fit.to_s * 1e3, 2)) " ms after the first sample: one plateau a channel"
            @if fit.drift { ", with a drift (zero shift)" } @else { ", without drift" } "; the number of bending modes is the one with the \
            lowest information criterion"
            @if is_lowest { "." } @else { " of those with which the second end is on the target as it strikes and the cask turns as the first impact \
            has it." } }
        div class="pair" {
            table class="whole" {
                caption { "Plateaus" }
                thead { tr { th { "Channel" } th class="n" { "Velocity step, m/s" } th class="n" { "u, m/s" } th class="n" { "Zero shift, m/s²" } th class="n" { "Residual, m/s" } } }
                tbody { @for p in &fit.plateaus { tr {
                    th scope="row" { (printable(&p.channel)) } td class="n" { (fixed(p.velocity_step_m_s, 3)) } td class="n" { (significant(p.u_m_s, 2)) }
                    td class="n" { (significant(p.zero_shift_m_s2, 2)) } td class="n" { (significant(p.residual_m_s, 2)) }
                } } }
            }
            div {
                table class="whole" {
                    caption { "Bending modes taken" }
                    thead { tr { th class="n" { "Frequency, Hz" } th class="n" { "Damping ratio" } th class="n" { "Amplitude, m/s" } } }
                    tbody {
                        @for m in &fit.modes { tr { td class="n" { (fixed(m.frequency_hz, 1)) } td class="n" { (significant(m.damping, 2)) } td class="n" { (significant(m.amplitude_m_s, 2)) } } }
                        @if fit.modes.is_empty() { tr { td colspan="3" { "none: nothing rings" } } }
                    }
                }
                table class="whole" {
                    caption { "Candidates that were tried; BIC: the lower the better" }
                    thead { tr { th { "Modes" } th { "Phases" } th { "Drift" } th class="n" { "BIC" } th class="n" { "Residual, m/s" } } }
                    tbody { @for c in &fit.candidates { tr class=[c.taken.then_some("chosen")] {
                        td { (c.modes) @if c.taken { " (taken)" } }
                        td { @if c.driven { "by the impact" } @else if c.modes > 0 { "free" } @else { "–" } }
                        td { @if c.drift { "yes" } @else { "no" } }
                        td class="n" { (fixed(c.bic, 1)) } td class="n" { (significant(c.residual_m_s, 2)) }
                    } } }
                }
            }
        }
    }
}

/// What each channel is worth.
pub(super) fn channels(result: &DropResult) -> Markup {
    let g = |value: Option<f64>| optional(value.map(|v| v / STANDARD_GRAVITY_M_S2), 3);
    html! {
        h2 { "Channels" }
        table {
            caption { "Offset, noise (RMS) and peaks in g; the peak is that of the filtered curve." }
            thead { tr { th { "Channel" } th { "End, axis" } th { "Source" } th class="n" { "Samples" } th class="n" { "Rate, kHz" } th { "Unit" }
                th class="n" { "Offset" } th class="n" { "Noise" } th class="n" { "Peak" } th class="n" { "Unfiltered" } } }
            tbody { @for c in &result.channels { tr {
                th scope="row" { (printable(&c.name)) } td { (end_axis(c.end, c.axis)) } td { code { (printable(&c.source)) } }
                td class="n" { (c.samples) } td class="n" { (plain(c.sample_rate_hz / 1e3, 6)) } td { (printable(&c.unit)) }
                td class="n" { (g(c.offset_m_s2)) } td class="n" { (g(c.noise_m_s2)) } td class="n" { (g(c.peak_filtered_m_s2)) } td class="n" { (g(c.peak_raw_m_s2)) }
            } } }
        }
    }
}

/// Which files, which version, which settings.
pub(super) fn provenance(result: &DropResult, file: &CaskFile) -> Markup {
    let stated = settings::of_cask_file(file, &result.settings);
    html! {
        h2 { "Provenance" }
        table class="whole" {
            tbody {
                tr { th scope="row" { "Recording" } td { (printable(&result.input.recording)) " (" (format_word(result.input.format)) ")" } }
                tr { th scope="row" { "its SHA-256" } td { code { (printable(&result.input.recording_sha256)) } } }
                tr { th scope="row" { "Cask file" } td { (printable(&result.input.cask)) } }
                tr { th scope="row" { "its SHA-256" } td { code { (printable(&result.input.cask_sha256)) } } }
                tr { th scope="row" { "Program" } td { "dropcheck " (result.version) } }
                tr { th scope="row" { "Slap-down speed" } td { (interval(result.slap_down.speed.as_ref())) " · result schema " (result.schema) } }
            }
        }
        table {
            caption { "Every setting and where it came from" }
            thead { tr { th { "Setting" } th { "Value" } th { "From" } } }
            tbody { @for s in result.settings.iter().chain(&stated) { tr {
                th scope="row" { (printable(&s.name)) } td { (true_minus(&printable(&s.value))) } td { (printable(&s.origin)) }
            } } }
        }
    }
}
