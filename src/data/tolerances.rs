//! Uncertainty of the stated values and permitted corrections: `[tolerance]` and `[corrections]` of a cask
//! file, one row per key.

use super::cask::Cask;
use super::key::{Key, Takes, range};
use ToleranceUnit::{Degrees, Metres, MetresOf, MetresPerSecond, Percent};

/// Unit of a tolerance in the cask file; the program holds it in SI units or as a share.
#[derive(Debug, Clone, Copy)]
enum ToleranceUnit {
    /// Percent of the thing itself, held as a share of it.
    Percent,
    /// Degrees, or degrees per second; the text is the unit in the report.
    Degrees(&'static str),
    /// Metres, shown in millimetres.
    Metres,
    /// Metres per second.
    MetresPerSecond,
    /// Metres, held as a share of this size and shown in percent of it; the default is in percent.
    MetresOf(fn(&Cask) -> f64),
}

impl ToleranceUnit {
    /// Converts the default of a row to the internal unit.
    fn default_held(self, default: f64) -> f64 {
        match self {
            Self::Percent | Self::MetresOf(_) => default / 100.0,
            Self::Degrees(_) => default.to_radians(),
            Self::Metres | Self::MetresPerSecond => default,
        }
    }
}

/// A key of `[tolerance]`.
#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    /// Key in the cask file.
    pub key: &'static str,
    /// Name in the report and in the budget of uncertainty.
    pub name: &'static str,
    unit: ToleranceUnit,
    held: fn(&mut Tolerances) -> &mut f64,
}

impl Tolerance {
    /// Stores a value in the unit of the file in `all`; a size of 0 has no tolerance.
    pub(crate) fn set(&self, all: &mut Tolerances, value: f64, cask: &Cask) {
        *(self.held)(all) = match self.unit {
            MetresOf(size_m) if size_m(cask) > 0.0 => value / size_m(cask),
            MetresOf(_) => 0.0,
            unit => unit.default_held(value),
        };
    }

    /// Value in the unit of the file.
    pub(crate) fn value_in_file(&self, mut all: Tolerances, cask: &Cask) -> f64 {
        let held = *(self.held)(&mut all);
        match self.unit {
            Percent => 100.0 * held,
            Degrees(_) => held.to_degrees(),
            Metres | MetresPerSecond => held,
            MetresOf(size_m) => held * size_m(cask),
        }
    }

    /// Value as the report shows it, and its unit.
    pub(crate) fn displayed_value(&self, mut all: Tolerances) -> (f64, &'static str) {
        let held = *(self.held)(&mut all);
        match self.unit {
            Percent | MetresOf(_) => (100.0 * held, " %"),
            Degrees(unit) => (held.to_degrees(), unit),
            Metres => (1e3 * held, " mm"),
            MetresPerSecond => (held, " m/s"),
        }
    }
}

/// Ten times a percentage, and the longest cask: larger tolerances would never end an analysis.
const WIDEST: f64 = 1000.0;

/// Declares the tolerances. A row has the field and its unit, the key with its unit and its default, the name
/// in the report, and the remark in the form that `init` writes; if the default depends on the cask, also the
/// words for it and an example.
macro_rules! tolerances {
    ($(
        $(#[$holds:meta])*
        $field:ident: $key:literal in $unit:expr, $default:literal
        $(($default_words:literal, $example:literal))?, $name:literal, $remark:literal;
    )*) => {
        /// 95 % half-widths of the values in the cask file and in the sensors' certificates.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Tolerances {
            $($(#[$holds])* pub $field: f64,)*
        }

        impl Default for Tolerances {
            /// Sources and sizes: docs/uncertainty.md.
            fn default() -> Self {
                Self { $($field: $unit.default_held($default),)* }
            }
        }

        /// Keys of `[tolerance]`, each a 95 % half-width in the unit of its ending.
        pub const TOLERANCE: [Key; TOLERANCES.len()] = [$(
            Key {
                name: $key,
                takes: range(0.0, WIDEST, "half-width of the 95 % interval, in the unit that ends the key"),
                default: [$($default_words,)? stringify!($default)][0],
                example: [$($example,)? stringify!($default)][0],
                remark: $remark,
                is_asked: false,
            },
        )*];

        /// Keys of `[tolerance]`, in their order.
        pub static TOLERANCES: [Tolerance; [$($key),*].len()] = [$(
            Tolerance { key: $key, name: $name, unit: $unit, held: |all| &mut all.$field },
        )*];
    };
}

tolerances! {
    /// Drop angle, rad.
    angle_rad: "angle_deg" in Degrees("°"), 0.4, "drop angle", "drop angle";
    /// Impact velocity, as a share of it.
    impact_velocity: "impact_velocity_percent" in Percent, 0.3, "impact velocity", "";
    /// Scale of a channel, as a share of it.
    calibration: "calibration_percent" in Percent, 1.0, "calibration of a channel", "scale of a channel";
    /// Share of the other body axis that a sensor reads: cross-axis sensitivity and tilt.
    cross_axis: "cross_axis_percent" in Percent, 2.0,
        "cross axis of a channel", "what a sensor reads of the other body axis, tilt included";
    /// Error that base strain, heat and the cable add to a sensor's reading in a contact, as a share of its
    /// peak.
    base_strain: "base_strain_percent" in Percent, 0.5,
        "base strain of a sensor", "of its peak in a contact, heat and cable included";
    /// Place of a sensor along the axis, m.
    position_m: "position_m" in Metres, 0.01,
        "position of a sensor", "place of a sensor along the axis, of an axial one off it";
    /// Length between the ends that strike, as a share of it.
    length: "length_m" in MetresOf(|cask| cask.length_m), 1.0 ("1 % of `length_m`", "0.05"),
        "length", "between the ends that strike; left out: 1 % of it";
    /// Section, as a share of it.
    height: "height_m" in MetresOf(|cask| cask.height_m), 1.0 ("1 % of `height_m`", "0.008"),
        "section", "section; left out: 1 % of it";
    /// Rotation at first contact, rad/s.
    angular_velocity_rad_s: "angular_velocity_deg_s" in Degrees("°/s"), 1.0,
        "rotation at first contact", "rotation as the first end strikes";
    /// Sideways velocity at first contact, m/s.
    horizontal_velocity_m_s: "horizontal_velocity_m_s" in MetresPerSecond, 0.1,
        "sideways velocity at first contact", "sideways velocity as the first end strikes";
    /// Centre of gravity, m.
    cog_m: "cog_m" in Metres, 0.01 ("0.01; 8 % of `length_m` where `cog_m` is left out", "0.01"),
        "centre of gravity", "centre of gravity";
    /// Inertia, as a share of it.
    inertia: "inertia_percent" in Percent, 2.0 ("2; 15 where `inertia_kg_m2` is left out", "2.0"),
        "inertia", "";
    /// Relative friction of the first contact: of the stated coefficient, or of the friction for sticking.
    friction: "friction_percent" in Percent, 20.0,
        "friction of the first contact", "of the coefficient, or of what sticking needs";
    /// Rate of the recorder's clock, as a share of it; all channels share it.
    clock: "clock_percent" in Percent, 0.05, "recorder's clock", "rate of the recorder's clock";
}

/// Half-width of an unstated centre of gravity, as a share of the length: those of casks lie at 42 to 58 %.
const UNSTATED_COG: f64 = 0.08;
/// Half-width of an unstated inertia, as a share of a block's: casks carry their mass off the even spread.
pub const UNSTATED_INERTIA: f64 = 0.15;

impl Tolerances {
    /// Defaults for a cask of this length, if its file omits these keys, as "table.key".
    pub fn with_defaults(left_out: &[String], length_m: f64) -> Self {
        let usual = Self::default();
        let is_left_out = |key: &str| left_out.iter().any(|left_out| left_out == key);
        Self {
            cog_m: if is_left_out("cask.cog_m") { UNSTATED_COG * length_m } else { usual.cog_m },
            inertia: if is_left_out("cask.inertia_kg_m2") { UNSTATED_INERTIA } else { usual.inertia },
            ..usual
        }
    }
}

/// Declares the corrections, each with its remark in the form that `init` writes and in the command's help.
macro_rules! corrections {
    ($($(#[$done:meta])* $key:ident: $remark:literal;)*) => {
        /// Permitted corrections of the samples; each correction is reported with its size.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(clippy::struct_excessive_bools, reason = "switches that have nothing to do with one another")]
        pub struct Corrections {
            $($(#[$done])* pub $key: bool,)*
        }

        impl Default for Corrections {
            fn default() -> Self {
                Self { $($key: true,)* }
            }
        }

        impl Corrections {
            /// Switches with their keys.
            pub fn switches(&mut self) -> [(&'static str, &mut bool); CORRECTIONS.len()] {
                [$((stringify!($key), &mut self.$key),)*]
            }
        }

        /// Keys of `[corrections]`.
        pub const CORRECTIONS: [Key; [$($remark),*].len()] = [$(
            Key {
                name: stringify!($key),
                takes: Takes::Flag,
                default: "true",
                example: "true",
                remark: $remark,
                is_asked: false,
            },
        )*];
    };
}

corrections! {
    /// The mean of the free fall is subtracted.
    offset: "mean of the free fall";
    /// A change of the offset at the first impact is fitted and subtracted.
    zero_shift: "change of the offset at the first impact";
    /// A channel that is stamped late or early is shifted.
    skew: "a channel stamped late or early";
    /// Mains hum seen in the free fall is subtracted.
    hum: "mains hum";
}
