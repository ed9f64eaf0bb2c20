//! Two sensors on a cask that slaps down, in closed form, to recordings of every format in a folder of their
//! own.

use dropcheck::data::CaskFile;
use dropcheck::ingest;
use mcap::records::MessageHeader;
use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::field_descriptor_proto::{Label, Type};
use prost_reflect::prost_types::{
    DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet,
};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::fmt::{Display, Formatter, Write as _};
use std::path::{Path, PathBuf};

const RATE_HZ: f64 = 500_000.0;
/// Samples a message.
const BLOCK: usize = 1000;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    Hdf5,
    Hdf5Gzip,
    Csv,
    McapJson,
    McapProtobuf,
}

impl Display for Kind {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self:?}")
    }
}

/// A recording and its cask file, gone with it.
pub struct Folder {
    pub recording: PathBuf,
    pub cask_file: CaskFile,
    _scratch: tempfile::TempDir,
}

impl Folder {
    pub fn with(kind: Kind, samples: usize) -> Self {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let recording = folder.path().join("recording");
        write(&recording, kind, &drop_g(samples));
        Self { recording, cask_file: cask_file(kind), _scratch: folder }
    }
}

/// The cask file for recordings of one kind.
pub fn cask_file(kind: Kind) -> CaskFile {
    let source = |name: &str| match kind {
        Kind::Hdf5 | Kind::Hdf5Gzip => format!("/daq/{name}"),
        Kind::Csv => name.to_owned(),
        Kind::McapJson | Kind::McapProtobuf => format!("/daq/{name}.samples"),
    };
    let channel = |name: &str, end: &str, position_m: f64| {
        format!(
            "[[channel]]\nname = \"{name}\"\nend = \"{end}\"\naxis = \"transverse\"\n\
             source = \"{}\"\nunit = \"g\"\nposition_m = {position_m}\n",
            source(name)
        )
    };
    let text = format!(
        "[cask]\nname = \"bench\"\nmass_kg = 4466.0\nlength_m = 5.5\nheight_m = 0.8\n\
         [drop]\nheight_m = 9.0\nangle_deg = 15.0\n{}{}",
        channel("a1", "first", 0.15),
        channel("a2", "second", 5.35)
    );
    let file = tempfile::NamedTempFile::new().expect("a scratch file");
    std::fs::write(file.path(), text).expect("a scratch file");
    ingest::cask_file(file.path()).expect("the bench's own cask file")
}

/// Half-sine pulses at both ends with free flight between, a mode of 62 Hz that rings after each, and noise;
/// in g.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "a test signal")]
fn drop_g(samples: usize) -> [Vec<f32>; 2] {
    // Contact in the middle, 6 ms long; slap-down 70 ms later. A rod that keeps half of its speed: 21 m/s at
    // L, −10 m/s at R.
    let contact_s = samples as f64 / RATE_HZ / 2.0;
    let pulse = |t: f64, length_s: f64, step_m_s: f64| {
        let inside = (0.0..length_s).contains(&t);
        f64::from(u8::from(inside)) * step_m_s * PI / (2.0 * length_s) * (PI * t / length_s).sin()
    };
    let ring = |t: f64, size_m_s2: f64| {
        let omega = TAU * 62.0;
        f64::from(u8::from(t > 0.0)) * size_m_s2 * (-0.03 * omega * t).exp() * (omega * t).sin()
    };
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24) - 0.5
    };
    [(21.0, 300.0, 4.0), (-10.0, 300.0, 30.0)].map(|(first_m_s, ring_m_s2, second_m_s)| {
        (0..samples)
            .map(|i| {
                let t = i as f64 / RATE_HZ - contact_s;
                let force = pulse(t, 0.006, first_m_s)
                    + ring(t - 0.003, ring_m_s2)
                    + pulse(t - 0.07, 0.005, second_m_s)
                    + ring(t - 0.0725, ring_m_s2);
                (force / 9.80665 + 0.5 * noise()) as f32
            })
            .collect()
    })
}

fn write(path: &Path, kind: Kind, [a1, a2]: &[Vec<f32>; 2]) {
    let channels = [("a1", a1), ("a2", a2)];
    match kind {
        Kind::Hdf5 | Kind::Hdf5Gzip => write_hdf5(path, &channels, kind == Kind::Hdf5Gzip).expect("HDF5"),
        Kind::Csv => {
            let mut text = "time_s,a1,a2\n".to_owned();
            for (i, (x, y)) in (0_u32..).zip(a1.iter().zip(a2)) {
                let _ = writeln!(text, "{:.6},{x:.3},{y:.3}", f64::from(i) / RATE_HZ);
            }
            std::fs::write(path, text).expect("CSV");
        }
        Kind::McapJson | Kind::McapProtobuf => {
            write_mcap(path, &channels, kind == Kind::McapProtobuf).expect("MCAP");
        }
    }
}

fn write_hdf5(path: &Path, channels: &[(&str, &Vec<f32>)], is_packed: bool) -> hdf5_metno::Result<()> {
    let file = hdf5_metno::File::create(path)?;
    let group = file.create_group("daq")?;
    for (name, samples) in channels {
        let builder = group.new_dataset_builder();
        let builder = if is_packed { builder.shuffle().deflate(4) } else { builder };
        let dataset = builder.with_data(samples.as_slice()).create(*name)?;
        dataset.new_attr::<f64>().create("sample_rate_hz")?.write_scalar(&RATE_HZ)?;
    }
    Ok(())
}

fn write_mcap(path: &Path, channels: &[(&str, &Vec<f32>)], is_protobuf: bool) -> mcap::McapResult<()> {
    let mut writer = mcap::Writer::new(std::io::BufWriter::new(std::fs::File::create(path)?))?;
    let (encoding, schema_encoding, schema) = if is_protobuf {
        ("protobuf", "protobuf", block_descriptors())
    } else {
        ("json", "jsonschema", b"{}".to_vec())
    };
    let schema = writer.add_schema("dropcheck.AccelerationBlock", schema_encoding, &schema)?;
    for (name, samples) in channels {
        let channel_id = writer.add_channel(schema, &format!("/daq/{name}"), encoding, &BTreeMap::new())?;
        for (number, block) in (0_u64..).zip(samples.chunks(BLOCK)) {
            // 1000 samples at 500 kHz are 2 ms.
            let time_ns = 1_700_000_000_000_000_000 + number * 2_000_000;
            let header = MessageHeader { channel_id, sequence: 0, log_time: time_ns, publish_time: time_ns };
            let data = if is_protobuf { protobuf_block(time_ns, block) } else { json_block(time_ns, block) };
            writer.write_to_known_channel(&header, &data)?;
        }
    }
    writer.finish().map(|_| ())
}

fn json_block(time_ns: u64, samples: &[f32]) -> Vec<u8> {
    let (sec, nsec) = (time_ns / 1_000_000_000, time_ns % 1_000_000_000);
    let mut text = format!(
        r#"{{"timestamp":{{"sec":{sec},"nsec":{nsec}}},"sample_rate_hz":{RATE_HZ},"unit":"g","samples":["#
    );
    for (i, x) in samples.iter().enumerate() {
        let _ = write!(text, "{}{x:.3}", if i == 0 { "" } else { "," });
    }
    text.push_str("]}");
    text.into_bytes()
}

/// The block message on the wire, by hand: samples packed, the stamp nested.
fn protobuf_block(time_ns: u64, samples: &[f32]) -> Vec<u8> {
    use prost_reflect::prost::encoding::encode_varint;
    let mut stamp = vec![0x08];
    encode_varint(time_ns / 1_000_000_000, &mut stamp);
    stamp.push(0x10);
    encode_varint(time_ns % 1_000_000_000, &mut stamp);
    let mut block = vec![0x0a];
    encode_varint(stamp.len() as u64, &mut block);
    block.extend(stamp);
    block.push(0x11);
    block.extend(RATE_HZ.to_le_bytes());
    block.extend([0x1a, 1, b'g', 0x22]);
    encode_varint(4 * samples.len() as u64, &mut block);
    block.extend(samples.iter().flat_map(|x| x.to_le_bytes()));
    block
}

fn block_descriptors() -> Vec<u8> {
    let field = |name: &str, number, kind: Type, type_name: Option<&str>| FieldDescriptorProto {
        name: Some(name.into()),
        number: Some(number),
        r#type: Some(kind.into()),
        type_name: type_name.map(String::from),
        label: Some(if name == "samples" { Label::Repeated } else { Label::Optional }.into()),
        ..FieldDescriptorProto::default()
    };
    let file =
        |name: &str, package: &str, dependency: Vec<String>, message: &str, field| FileDescriptorProto {
            name: Some(name.into()),
            package: Some(package.into()),
            syntax: Some("proto3".into()),
            dependency,
            message_type: vec![DescriptorProto {
                name: Some(message.into()),
                field,
                ..DescriptorProto::default()
            }],
            ..FileDescriptorProto::default()
        };
    let stamp_file = "google/protobuf/timestamp.proto";
    let stamp_fields = vec![field("seconds", 1, Type::Int64, None), field("nanos", 2, Type::Int32, None)];
    let block_fields = vec![
        field("timestamp", 1, Type::Message, Some(".google.protobuf.Timestamp")),
        field("sample_rate_hz", 2, Type::Double, None),
        field("unit", 3, Type::String, None),
        field("samples", 4, Type::Float, None),
    ];
    let stamp = file(stamp_file, "google.protobuf", vec![], "Timestamp", stamp_fields);
    let block = file("block.proto", "dropcheck", vec![stamp_file.into()], "AccelerationBlock", block_fields);
    FileDescriptorSet { file: vec![stamp, block] }.encode_to_vec()
}
