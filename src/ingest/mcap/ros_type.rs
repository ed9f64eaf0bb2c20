//! A schema's `ros2msg` text to a tree of types, every named type put in its place.

use super::path::Step;
use crate::ingest::number_type::NumberType;
use re_ros_msg::MessageSchema;
use re_ros_msg::message_spec::{
    ArraySize, BuiltInType, ComplexType, MessageSpecification, Type as Parsed, message_package,
};
use std::collections::HashMap;

/// ROS messages are not nested deeper; a type within itself is damage.
const DEEPEST: usize = 16;
/// More fields than any message has: types that double at each level would fill the memory.
pub(super) const MOST_FIELDS: usize = 20_000;

/// A field of a message.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RosField {
    pub(super) name: String,
    /// The name of its message type, where it is a message.
    pub(super) type_name: Option<String>,
    pub(super) kind: Type,
}

impl RosField {
    fn number(name: &str, number: NumberType) -> Self {
        Self { name: name.to_owned(), type_name: None, kind: Type::Number(number) }
    }
}

/// What stands in a field.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Type {
    Number(NumberType),
    Text,
    /// Text of wide letters.
    WideText,
    Message(Vec<RosField>),
    /// Of so many elements, or as many as the message says.
    Array(Box<Type>, Option<usize>),
}

/// Whether one of `fields` or what lies below it is at `path`.
pub(super) fn has(fields: &[RosField], path: &[Step]) -> bool {
    let [Step::Name(name), below @ ..] = path else { return false };
    let mut kinds = fields.iter().filter(|field| field.name == *name).map(|field| &field.kind);
    kinds.any(|kind| kind.has(below))
}

impl Type {
    /// Whether something is at `path` in it.
    fn has(&self, path: &[Step]) -> bool {
        match (self, path) {
            (_, []) => true,
            (Self::Message(fields), path) => has(fields, path),
            (Self::Array(element, _), [Step::Index(_), below @ ..]) => element.has(below),
            _ => false,
        }
    }

    /// What needs no other definition.
    fn plain(kind: &BuiltInType) -> Self {
        Self::Number(match kind {
            BuiltInType::Bool | BuiltInType::Byte | BuiltInType::Char | BuiltInType::UInt8 => NumberType::U8,
            BuiltInType::UInt16 => NumberType::U16,
            BuiltInType::UInt32 => NumberType::U32,
            BuiltInType::UInt64 => NumberType::U64,
            BuiltInType::Int8 => NumberType::I8,
            BuiltInType::Int16 => NumberType::I16,
            BuiltInType::Int32 => NumberType::I32,
            BuiltInType::Int64 => NumberType::I64,
            BuiltInType::Float32 => NumberType::F32,
            BuiltInType::Float64 => NumberType::F64,
            BuiltInType::String(_) => return Self::Text,
            BuiltInType::WString(_) => return Self::WideText,
        })
    }

    /// Whether text of wide letters stands in it.
    pub(super) fn has_wide_text(&self) -> bool {
        match self {
            Self::WideText => true,
            Self::Number(_) | Self::Text => false,
            Self::Message(fields) => fields.iter().any(|field| field.kind.has_wide_text()),
            Self::Array(element, _) => element.has_wide_text(),
        }
    }
}

/// The fields of the message `name` from its schema's text; each is taken from what is `left`.
///
/// # Errors
/// Why the text gives no type.
pub(super) fn parse(name: &str, text: &str, left: &mut usize) -> Result<Vec<RosField>, String> {
    // Neither defaults nor constants are sent, and the crate panics where one of them is a quotation mark
    // alone. It leaves out a definition at the end that has no line: one without fields.
    let text = text.replace(['"', '\''], "_") + "\n#\n";
    let schema =
        MessageSchema::parse(name, &text).map_err(|error| format!("its schema does not parse: {error:#}"))?;
    let mut resolver = Resolver { of_package: HashMap::new(), of_any: HashMap::new(), left };
    for spec in &schema.dependencies {
        let name = spec.name.rsplit('/').next().unwrap_or_default();
        resolver.of_package.entry((message_package(&spec.name), name)).or_insert(spec);
        resolver.of_any.entry(name).or_insert(spec);
    }
    resolver.message(&schema.spec, DEEPEST)
}

/// The named types, the first of a name.
struct Resolver<'a> {
    of_package: HashMap<(Option<&'a str>, &'a str), &'a MessageSpecification>,
    of_any: HashMap<&'a str, &'a MessageSpecification>,
    /// How many fields may still be taken.
    left: &'a mut usize,
}

impl Resolver<'_> {
    fn message(&mut self, spec: &MessageSpecification, depth: usize) -> Result<Vec<RosField>, String> {
        if depth == 0 {
            return Err(format!("its schema nests {} in itself", spec.name));
        }
        let mut fields = Vec::with_capacity(spec.fields.len());
        for field in &spec.fields {
            *self.left = self.left.checked_sub(1).ok_or("its schema has too many fields")?;
            let kind = self.kind(&field.ty, message_package(&spec.name), depth)?;
            let type_name = match &field.ty {
                Parsed::Complex(ComplexType::Absolute { package, name }) => Some(format!("{package}/{name}")),
                _ => None,
            };
            fields.push(RosField { name: field.name.clone(), type_name, kind });
        }
        if fields.is_empty() {
            // A message of constants alone takes one byte on the wire.
            fields.push(RosField::number("structure_needs_at_least_one_member", NumberType::U8));
        }
        Ok(fields)
    }

    fn kind(&mut self, ty: &Parsed, package: Option<&str>, depth: usize) -> Result<Type, String> {
        match ty {
            Parsed::BuiltIn(plain) => Ok(Type::plain(plain)),
            Parsed::Array { ty, size } => {
                let length = if let ArraySize::Fixed(count) = size { Some(*count) } else { None };
                Ok(Type::Array(Box::new(self.kind(ty, package, depth)?), length))
            }
            Parsed::Complex(complex) => self.named(complex, package, depth),
        }
    }

    fn named(&mut self, complex: &ComplexType, package: Option<&str>, depth: usize) -> Result<Type, String> {
        let (package, name) = match complex {
            ComplexType::Absolute { package, name } => (Some(package.trim_end_matches("/msg")), name),
            ComplexType::Relative { name } => (package, name),
        };
        let is_relative = matches!(complex, ComplexType::Relative { .. });
        let of_any = || self.of_any.get(name.as_str()).filter(|_| is_relative);
        match self.of_package.get(&(package, name.as_str())).or_else(of_any).copied() {
            Some(spec) => Ok(Type::Message(self.message(spec, depth - 1)?)),
            // Some writers leave out what every ROS 2 installation has.
            None if name == "Time" || name == "Duration" => Ok(Type::Message(vec![
                RosField::number("sec", NumberType::I32),
                RosField::number("nanosec", NumberType::U32),
            ])),
            None => Err(format!("its schema uses the type {name} and does not define it")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_types_are_put_in_place_and_a_missing_time_is_known() {
        let text = "std_msgs/Header header\nVec v\nfloat64[9] c\nint16[<=4] d\n================\nMSG: \
                    std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n================\nMSG: \
                    my/Vec\nfloat32 x # comment\nuint8 OFF=0\n";
        let fields = parse("my/msg/Top", text, &mut 20_000).unwrap();
        let Type::Message(header) = &fields[0].kind else { panic!() };
        assert!(matches!(&header[0].kind, Type::Message(time) if time.len() == 2));
        assert_eq!(fields[1].kind, Type::Message(vec![RosField::number("x", NumberType::F32)]));
        assert_eq!(fields[2].kind, Type::Array(Box::new(Type::Number(NumberType::F64)), Some(9)));
        assert_eq!(fields[3].kind, Type::Array(Box::new(Type::Number(NumberType::I16)), None));
    }

    #[test]
    fn a_quotation_mark_alone_is_no_end_of_the_program() {
        let fields =
            parse("my/msg/Top", "string s \"\nstring A='\nstring[] t [',']\nfloat64 x # \"\n", &mut 20_000)
                .unwrap();
        let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
        assert_eq!(names, ["s", "t", "x"]);
    }

    #[test]
    fn a_type_in_itself_and_an_unknown_one_are_errors() {
        let itself = "Node next\n===\nMSG: my/Node\nNode next\n";
        assert!(parse("my/msg/Top", itself, &mut 20_000).unwrap_err().contains("in itself"));
        assert!(parse("my/msg/Top", "other/Thing t\n", &mut 20_000).unwrap_err().contains("Thing"));
    }
}
