//! Quantities of interest by name, as numbers or with their intervals, and the parts of the result for the
//! first impact and the slap-down.

use super::estimate::Estimate;
use super::motion::Motion;
use serde::Serialize;

/// Declares numbers by their names, each with its unit: a struct over any type, with conversions to and from
/// a flat array for linear algebra, in the order of declaration. A number of `may_be_missing` is an `Option`.
macro_rules! named_numbers {
    (
        $(#[$about:meta])*
        pub struct $name:ident<T = $default:ty> { $($(#[$field_about:meta])* $field:ident: $unit:literal,)* }
        may_be_missing { $($(#[$optional_about:meta])* $optional:ident: $optional_unit:literal,)* }
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name<T = $default> {
            $($(#[$field_about])* pub $field: T,)*
            $($(#[$optional_about])* pub $optional: Option<T>,)*
        }

        impl $name<&'static str> {
            /// The unit of each number.
            pub const UNITS: Self = Self { $($field: $unit,)* $($optional: Some($optional_unit),)* };
        }

        impl $name<f64> {
            /// Number of quantities.
            pub const COUNT: usize = [$($unit,)* $($optional_unit,)*].len();

            /// The numbers in the order of declaration, 0 for a missing one.
            pub fn into_array(self) -> [f64; Self::COUNT] {
                [$(self.$field,)* $(self.$optional.unwrap_or_default(),)*]
            }
        }

        impl<T> $name<T> {
            /// The numbers by their places in the order of declaration; none is missing.
            pub fn from_fn(mut number: impl FnMut(usize) -> T) -> Self {
                let mut count = 0;
                let mut next = || {
                    count += 1;
                    number(count - 1)
                };
                Self { $($field: next(),)* $($optional: Some(next()),)* }
            }

            /// Applies a function to each quantity.
            pub fn map<U>(self, mut change: impl FnMut(T) -> U) -> $name<U> {
                $name { $($field: change(self.$field),)* $($optional: self.$optional.map(&mut change),)* }
            }

            /// Pairs the quantities by name; missing where either is.
            pub fn zip<U>(self, others: $name<U>) -> $name<(T, U)> {
                $name {
                    $($field: (self.$field, others.$field),)*
                    $($optional: self.$optional.zip(others.$optional),)*
                }
            }
        }
    };
}
pub(super) use named_numbers;

/// A quantity as a report lists it.
#[derive(Debug, Clone, Copy)]
pub struct QuantityRow {
    /// Name of the quantity.
    pub name: &'static str,
    /// Origin or sign convention of the quantity.
    pub remark: &'static str,
    /// Value of the quantity.
    pub value: Option<Estimate>,
}

/// Declares the quantities once, each with its unit, its name and remark in a report (none if the name is
/// empty), and its formula from the motion: those of the first impact, those of the slap-down, which are
/// missing if there is none, and those that the result states beside both. The first two are also parts of
/// the result, together with the time of the event.
macro_rules! quantities {
    (
        $(#[$first_about:meta])*
        FirstImpact {
            $(
                $(#[$first_field:meta])*
                $first:ident: $first_unit:literal, $first_words:expr => |$first_m:ident| $first_by:expr;
            )*
        }
        $(#[$second_about:meta])*
        SlapDown {
            $(#[$local_about:meta])* local_speed: $local_words:expr,
            $(
                $(#[$second_field:meta])*
                $second:ident: $second_unit:literal, $second_words:expr => |$second_m:ident| $second_by:expr;
            )*
        }
        beside {
            $($(#[$beside_about:meta])* $beside:ident: $beside_unit:literal => |$m:ident| $beside_of:expr;)*
        }
    ) => {
        named_numbers! {
            /// All quantities that follow from the reconstructed motion.
            pub struct Quantities<T = Estimate> {
                $($(#[$first_field])* $first: $first_unit,)*
                $($(#[$beside_about])* $beside: $beside_unit,)*
            }
            may_be_missing { $($(#[$second_field])* $second: $second_unit,)* }
        }

        impl Quantities<f64> {
            /// Computes the quantities of a motion.
            pub fn from_motion(motion: &Motion) -> Self {
                $(let $first = { let $first_m = motion; $first_by };)*
                $(let $beside = { let $m = motion; $beside_of };)*
                $(let $second = { let $second_m = motion; $second_by };)*
                Self { $($first,)* $($beside,)* $($second,)* }
            }
        }

        quantities!(part $(#[$first_about])* FirstImpact {}
            { $($(#[$first_field])* $first: $first_words => |all| all.$first.into();)* });
        quantities!(part $(#[$second_about])* SlapDown { $(#[$local_about])* local_speed: $local_words }
            { $($(#[$second_field])* $second: $second_words => |all| all.$second;)* });
    };
    (part $(#[$about:meta])* $name:ident { $($(#[$beside_about:meta])* $beside:ident: $beside_words:expr)? }
        { $($(#[$field_about:meta])* $field:ident: $words:expr => |$all:ident| $of:expr;)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq, Default, Serialize)]
        pub struct $name {
            /// First contact of the end, s from the recording's first sample.
            pub time: Option<Estimate>,
            $($(#[$field_about])* pub $field: Option<Estimate>,)*
            $($(#[$beside_about])* pub $beside: Option<Estimate>,)?
        }

        impl $name {
            /// Combines a time with the quantities, if they are measured.
            pub fn new(time: Option<Estimate>, measured: Option<&Quantities>) -> Self {
                Self { time, $($field: measured.and_then(|$all| $of),)* $($beside: None,)? }
            }

            /// Scales the quantities of a model of this scale to the prototype; the time of the recording
            /// does not scale.
            pub fn to_prototype(&self, scale: f64) -> Self {
                let scaled = |estimate: Option<Estimate>| estimate.map(|model| model.to_prototype(scale));
                Self { time: None, $($field: scaled(self.$field),)* $($beside: scaled(self.$beside),)? }
            }

            /// The quantities except the time.
            pub fn rows(&self) -> Vec<QuantityRow> {
                let row = |(name, remark), value| QuantityRow { name, remark, value };
                let all = [$(row($words, self.$field),)* $(row($beside_words, self.$beside),)?];
                all.into_iter().filter(|row| !row.name.is_empty()).collect()
            }
        }
    };
}

quantities! {
    /// The first impact.
    FirstImpact {
        /// Speed at first contact, m/s.
        impact_velocity: "m/s", ("impact velocity", "by the cask file") => |m| m.impact_m_s;
        /// Time from first contact to separation, s.
        duration: "s", ("contact lasts", "") => |m| m.separation.time_s - m.contact.time_s;
        /// Vertical velocity of L as it leaves the target, positive up, m/s   (22)
        rebound_velocity: "m/s", ("rebound velocity", "vertical, up positive") => |m| m.rebound_m_s;
        /// ω after the impact, rad/s.
        angular_velocity: "rad/s", ("angular velocity", "") => |m| m.separation.angular_velocity_rad_s;
    }
    /// The slap-down of R.
    SlapDown {
        /// Magnitude of the velocity of R's corner when it strikes, including ringing and rigid movement on
        /// mounts, m/s (44)
        local_speed: ("speed (corner)", "with ringing and swinging"),
        /// Magnitude of R's velocity just before it strikes, m/s   (24)
        speed: "m/s", ("speed (rigid cask)", "just before the second end strikes") =>
            |m| m.second_end_m_s.map(|(x, z)| x.hypot(z));
        /// Vertical component, negative down, m/s.
        vertical_velocity: "m/s", ("vertical velocity", "up positive") =>
            |m| m.second_end_m_s.map(|(_, z)| z);
        /// Horizontal component, m/s.
        horizontal_velocity: "m/s", ("horizontal velocity", "") => |m| m.second_end_m_s.map(|(x, _)| x);
        /// Inclination of the axis at slap-down, degrees.
        angle: "deg", ("angle", "of the axis above the horizontal") =>
            |m| m.slap_down.map(|s| s.angle_rad.to_degrees());
        /// Time from separation of L to slap-down, s.
        flight_time: "s", ("flight time", "from separation") =>
            |m| m.slap_down.map(|s| s.time_s - m.separation.time_s);
        /// Height of R's corner above the target then, m: 0 within its interval if angle, height and scales
        /// fit the recording.
        second_end_height: "m", ("", "") => |m| m.second_end_height_m;
    }
    beside {
        /// Restitution: −ż_L after the first impact over ż_L before   (23)
        k: "1" => |m| m.rebound_m_s / m.impact_m_s;
        /// Horizontal velocity of L's corner when it leaves, m/s: 0 within its interval if it sticks.
        slip_velocity: "m/s" => |m| m.slip_m_s;
        /// I_x / I_z of the first contact: the friction that acted.
        friction: "1" => |m| m.impulse_ratio;
    }
}

/// Contribution of one input to the uncertainty of the two headline quantities.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contribution {
    /// Name of the input for a reader: "calibration of A1".
    pub input: String,
    /// Standard uncertainty of the input, with its unit.
    pub standard_uncertainty: String,
    /// Its key of `[tolerance]`; `None` if the recording determines it.
    #[serde(skip)]
    pub tolerance: Option<&'static str>,
    /// Change of the slap-down speed due to it, m/s.
    pub speed_m_s: Option<f64>,
    /// Change of k due to it.
    pub k: Option<f64>,
}

/// A stated input that this recording cannot check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Untested {
    /// Name of the input for a reader: "drop height".
    pub what: String,
    /// Key in the cask file: "drop.height_m", "channel.A1.position_m".
    pub key: String,
    /// A mistake in it: "1 %".
    pub by: &'static str,
    /// Change of the result that such a mistake causes.
    pub moves: UntestedMoves,
    /// Measure that would check the input.
    pub remedy: &'static str,
}

/// Change of the slap-down speed and k that a mistake causes; `None` for a number that is not stated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct UntestedMoves {
    /// k.
    pub k: Option<f64>,
    /// The slap-down speed, m/s.
    pub slap_down_speed_m_s: Option<f64>,
}

impl UntestedMoves {
    /// The larger effect, in half-widths of the quantity.
    pub fn in_half_widths(&self, quantities: &Quantities) -> f64 {
        let share =
            |by: Option<f64>, moved: Option<Estimate>| by.zip(moved).map_or(0.0, |(by, of)| by / of.u95);
        share(self.k, Some(quantities.k)).max(share(self.slap_down_speed_m_s, quantities.speed))
    }
}
