//! The cask file, checked: the cask, the drop, the contact, the filter and the channels.

use super::planar::first_arm_m;
use super::test_record::SensorRecord;
use serde::Serialize;

/// L may sink this share of the length below the height at which it left before that counts as another impact
/// (9)
///
/// After k → 0 the free corner of a thin rod sinks by some millimetres while R comes down (11 mm for 5.5 m at
/// 15°, 42 mm at 45°, 0.5 m at 60°): less than the first impact has crushed it, so it meets nothing.
pub const GRAZE_SHARE: f64 = 0.01;

/// No cask of a few metres bends more slowly, Hz: a slower mode belongs to the cask as a whole, which moves
/// on its contents or is pressed on the target.
pub const SLOWEST_BENDING_HZ: f64 = 25.0;

/// Upper limit on channels, more than any drop test has; `init` gives each a table of twenty lines.
pub const MOST_CHANNELS: usize = 1000;

/// Accepted sample rates, Hz: the fastest transient recorders take 10⁸ samples a second, and below one in a
/// quarter of an hour no drop is visible. The limit also bounds the sample counts of filters and windows.
pub const SAMPLE_RATES_HZ: std::ops::RangeInclusive<f64> = 1e-3..=1e8;

/// An end of the cask.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// L: low, touches first.
    #[default]
    First,
    /// R: high, slaps down.
    Second,
}

impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::First => "first",
            Self::Second => "second",
        })
    }
}

/// A body axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// η, away from the target.
    #[default]
    Transverse,
    /// ξ, from L to R.
    Axial,
}

/// Direction in which a sensor on the skin reads: away from the axis of the cask, towards a growing angle
/// around it, or along it from L to R.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the words above")]
pub enum SkinDirection {
    Radial,
    Tangential,
    Axial,
}

/// Place of a sensor around the skin, and the direction in which it reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinPlace {
    /// Angle from the lowest line (0) over the side (π/2) to the uppermost line (π), rad.
    pub around_rad: f64,
    /// Direction in which it reads.
    pub direction: SkinDirection,
}

impl SkinPlace {
    /// Shares that the sensor reads of an acceleration away from the target (an axial sensor: along the
    /// axis), and of one across the plane of the drop   (53)
    pub fn shares(self) -> [f64; 2] {
        let (sin, cos) = self.around_rad.sin_cos();
        match self.direction {
            SkinDirection::Radial => [-cos, sin],
            SkinDirection::Tangential => [sin, cos],
            SkinDirection::Axial => [1.0, 0.0],
        }
    }

    /// True if the sensor reads across the plane of the drop, within 6°: it shows next to nothing of the
    /// motion in the plane.
    pub fn is_across(self) -> bool {
        self.shares()[0].abs() < 0.1
    }
}

/// Tangential contact law of the first end on the target.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Contact {
    /// The contact point does not slide.
    Rough,
    /// No tangential force.
    Smooth,
    /// Coulomb friction with this coefficient.
    Coulomb(f64),
    /// Nobody says: anything from smooth to rough.
    #[default]
    Unknown,
}

impl std::fmt::Display for Contact {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Rough => f.write_str("rough"),
            Self::Smooth => f.write_str("smooth"),
            Self::Coulomb(coefficient) => write!(f, "{coefficient}"),
            Self::Unknown => f.write_str("unknown"),
        }
    }
}

impl Serialize for Contact {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Coupling of a sensor.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Coupling {
    /// Down to 0 Hz.
    #[default]
    Dc,
    /// A first-order high-pass with this time constant, s.
    Ac {
        /// T of the high-pass T s / (1 + T s), s.
        time_constant_s: f64,
    },
}

/// The unit a channel's samples are in, as the cask file declares it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    /// Standard gravity, 9.80665 m/s².
    G,
    /// m/s².
    MetrePerSecondSquared,
    /// Volt, with the sensor's sensitivity, mV per g.
    Volt {
        /// mV per g.
        sensitivity_mv_per_g: f64,
    },
    /// Millivolt, with the sensor's sensitivity, mV per g.
    Millivolt {
        /// mV per g.
        sensitivity_mv_per_g: f64,
    },
}

/// Location of a channel's samples: as written, and for MCAP the topic and the field separately if the file
/// gives them so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// `"/topic.field.field"`, `"/group/dataset[2]"` or a CSV header.
    Path(String),
    /// `{ topic = "/a.b", field = "x.y" }`.
    TopicField {
        /// The topic.
        topic: String,
        /// The dotted field path.
        field: String,
        /// The number of the MCAP channel, where several write on the topic.
        channel: Option<u16>,
    },
}

/// Selects the rows of a table, or the messages of a topic, that belong to one sensor.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct RowsOf {
    /// The column, field or dataset that names the sensor.
    pub column: String,
    /// Content of that column in the sensor's rows.
    pub is: String,
}

impl std::fmt::Display for RowsOf {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "where = {{ column = {:?}, is = {:?} }}", self.column, self.is)
    }
}

impl Default for Source {
    fn default() -> Self {
        Self::Path(String::new())
    }
}

impl std::fmt::Display for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Path(path) => f.write_str(path),
            Self::TopicField { topic, field, channel: None } => write!(f, "{topic} · {field}"),
            Self::TopicField { topic, field, channel: Some(channel) } => {
                write!(f, "{topic} · {field} of channel {channel}")
            }
        }
    }
}

/// The `[filter]` table.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum FilterChoice {
    /// Chosen from the mass and the data.
    #[default]
    Auto,
    /// A channel frequency class of SAE J211 / ISO 6487.
    Cfc(f64),
    /// A −3 dB cut-off, Hz.
    CutoffHz(f64),
}

/// The `[cask]` table with its defaults filled in.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Cask {
    /// The cask's name.
    pub name: String,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Length along the axis between the two ends that strike, m.
    pub length_m: f64,
    /// Section in the plane of the drop, m; 0 is a thin rod.
    pub height_m: f64,
    /// Section across the plane, m.
    pub width_m: Option<f64>,
    /// Centre of gravity from the first end, m; l/2 if the file does not state it.
    pub cog_m: f64,
    /// Inertia about the centre of gravity, kg m²; m (l² + h²)/12 if the file does not state it.
    pub inertia_kg_m2: f64,
    /// True if the file gives `height_m` (above 0), `cog_m` or `inertia_kg_m2`: then the body is predicted
    /// beside the rod.
    pub is_body: bool,
}

/// The `[drop]` table with its defaults filled in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Drop {
    /// Free-fall height of the lowest point, m; of the centre of gravity if the cask rotates.
    pub height_m: f64,
    /// φ0, rad.
    pub angle_rad: f64,
    /// Speed at which L strikes, m/s: √(2 g h) − ω a (3), or as the file states.
    pub impact_velocity_m_s: f64,
    /// True if the file states the impact speed itself.
    pub impact_velocity_given: bool,
    /// g, m/s².
    pub gravity_m_s2: f64,
    /// ω at first contact, rad/s: positive brings R down.
    pub angular_velocity_rad_s: f64,
    /// ẋ of the centre of gravity at first contact, m/s.
    pub horizontal_velocity_m_s: f64,
    /// Duration of L's first impact, s: `[contact] duration_s`, or the measured value; 0 is an impulse.
    pub contact_duration_s: f64,
}

impl Cask {
    /// A homogeneous block.
    pub fn block(name: &str, mass_kg: f64, length_m: f64, height_m: f64) -> Self {
        Self {
            name: name.to_owned(),
            mass_kg,
            length_m,
            height_m,
            width_m: None,
            cog_m: length_m / 2.0,
            inertia_kg_m2: block_inertia_kg_m2(mass_kg, length_m, height_m),
            is_body: height_m > 0.0,
        }
    }
}

/// Inertia of a homogeneous block about its centre, kg m²: m (l² + h²) / 12.
pub fn block_inertia_kg_m2(mass_kg: f64, length_m: f64, height_m: f64) -> f64 {
    mass_kg * (length_m * length_m + height_m * height_m) / 12.0
}

impl Drop {
    /// Reading at rest of an ideal channel on this axis, m/s².
    pub fn weight_m_s2(&self, axis: Axis) -> f64 {
        let (along, across) = self.angle_rad.sin_cos();
        self.gravity_m_s2 * if axis == Axis::Axial { along } else { across }
    }

    /// A free fall from this height at 9.81 m/s², without rotation.
    pub fn from_height(height_m: f64, angle_rad: f64) -> Self {
        Self {
            height_m,
            angle_rad,
            impact_velocity_m_s: (2.0 * 9.81 * height_m).sqrt(),
            gravity_m_s2: 9.81,
            ..Self::default()
        }
    }

    /// Adds `more_rad_s` to the rotation of the same fall of the centre of gravity: v0 = √(2 g h) − ω a   (3)
    pub fn add_rotation(self, cask: &Cask, more_rad_s: f64) -> Self {
        let a_m = first_arm_m(cask.cog_m, cask.height_m, self.angle_rad);
        Self {
            angular_velocity_rad_s: self.angular_velocity_rad_s + more_rad_s,
            impact_velocity_m_s: self.impact_velocity_m_s - more_rad_s * a_m,
            ..self
        }
    }

    /// v0 cos φ0, m/s: the least velocity that a struck end loses across the axis.
    pub fn transverse_velocity_m_s(&self) -> f64 {
        self.impact_velocity_m_s * self.angle_rad.cos()
    }

    /// True if the cask falls onto its end face, within the usual error of a release.
    pub fn is_on_end(&self) -> bool {
        self.angle_rad.to_degrees() >= 88.0
    }

    /// A tenth of v0, m/s: a smaller velocity change of an end is no first impact.
    pub fn least_impact_m_s(&self) -> f64 {
        0.1 * self.impact_velocity_m_s
    }
}

/// Lowest speed at which bending travels along a cask, m/s: a 5 ms pulse in one that bends at 50 Hz travels
/// its length in 5 ms.
pub const BENDING_WAVE_M_S: f64 = 1000.0;

/// One `[[channel]]` table of the cask file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChannelSpec {
    /// Name, unique in the file.
    pub name: String,
    /// End of the cask at which the sensor sits.
    pub end: End,
    /// Along which axis it reads.
    pub axis: Axis,
    /// Location of the samples.
    pub source: Source,
    /// Declared unit; `None` uses that of the recording.
    pub unit: Option<Unit>,
    /// Position along the axis from the first end, m.
    pub position_m: f64,
    /// Position across the axis, positive away from the target, m.
    pub offset_m: f64,
    /// 1.0 or −1.0.
    pub polarity: f64,
    /// Factor from the samples as read to the unit, if the file states it.
    pub scale: Option<f64>,
    /// Full scale, at which the channel clips, in its unit.
    pub full_scale: Option<f64>,
    /// Sample rate that replaces that of the recording, Hz.
    pub sample_rate_hz: Option<f64>,
    /// The recording beside the cask file that holds the channel, if it belongs to another recorder.
    pub file: Option<String>,
    /// Rows of the source that belong to this sensor, if the source holds several sensors.
    pub rows: Option<RowsOf>,
    /// Times of this channel alone: a CSV column, an HDF5 dataset, a field of the messages.
    pub time: Option<String>,
    /// Coupling of the sensor.
    pub coupling: Coupling,
    /// 95 % half-width of this channel's scale, as a share, if the file states one for the channel.
    pub calibration: Option<f64>,
    /// Reference of the calibration: channels with the same reference share the error of their scale.
    pub reference: Option<String>,
    /// Place off the plane of the drop, m.
    pub lateral_m: f64,
    /// Place around the skin and direction of reading, if the file states these instead of an axis.
    pub skin: Option<SkinPlace>,
    /// Type, serial number and calibration of the sensor.
    pub sensor: SensorRecord,
}

impl ChannelSpec {
    /// Share, with its sign, that the sensor reads of an acceleration along its axis; 1 for a sensor that
    /// reads across the plane of the drop.
    pub fn axis_share(&self) -> f64 {
        self.skin.filter(|skin| !skin.is_across()).map_or(1.0, |skin| skin.shares()[0])
    }

    /// Shares that the channel reads along the axis, away from the target and across the plane of the drop
    /// (53)
    pub fn direction(&self) -> [f64; 3] {
        let [own, across] = self.skin.map_or([1.0, 0.0], SkinPlace::shares);
        if self.axis == Axis::Axial { [own, 0.0, 0.0] } else { [0.0, own, across] }
    }

    /// A DC-coupled transverse channel on the axis, in the unit of its recording, with nothing else stated.
    pub fn new(name: &str, end: End, source: &str, position_m: f64) -> Self {
        let (name, source) = (name.to_owned(), Source::Path(source.to_owned()));
        Self { name, end, source, position_m, polarity: 1.0, ..Self::default() }
    }
}
