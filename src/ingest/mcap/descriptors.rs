//! A protobuf schema's serialised descriptor set to the message type that it names, without what numbers do
//! not need.

use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::{
    DescriptorProto, EnumDescriptorProto, FieldOptions, FileDescriptorProto, FileDescriptorSet,
    MessageOptions,
};
use prost_reflect::{DescriptorPool, MessageDescriptor};

/// What the names of imported files take where each file of a set is made to import all others, bytes: those
/// of five hundred files.
const MOST_NAMES_BYTES: usize = 16 << 20;

/// The message type that `schema_name` names in a serialised descriptor set.
///
/// # Errors
/// Why there is none.
pub(super) fn message_type(schema_name: &str, descriptor_set: &[u8]) -> Result<MessageDescriptor, String> {
    let unusable =
        |why: String| format!("its schema {schema_name:?} holds no descriptor set that can be used: {why}");
    let mut set = FileDescriptorSet::decode(descriptor_set).map_err(|error| unusable(error.to_string()))?;
    for file in &mut set.file {
        // The library that links the types takes any other for its own mistake, and stops the program.
        if let Some(syntax) = file.syntax.as_deref().filter(|syntax| !["proto2", "proto3"].contains(syntax)) {
            return Err(unusable(format!("it is in the syntax {syntax:?}, and proto2 and proto3 are read")));
        }
        simplify(file);
    }
    publish(&mut set).map_err(unusable)?;
    let pool = DescriptorPool::from_file_descriptor_set(set).map_err(|error| unusable(error.to_string()))?;
    pool.get_message_by_name(schema_name.trim_start_matches('.'))
        .ok_or_else(|| format!("its schema's descriptor set holds no message {schema_name:?}"))
}

/// Lets every file import all others where one imports another for its importers too (`import public`): the
/// library that links the types follows such imports anew for each way that leads to them, and for ever where
/// a file leads to itself.
fn publish(set: &mut FileDescriptorSet) -> Result<(), String> {
    if set.file.iter().all(|file| file.public_dependency.is_empty()) {
        return Ok(());
    }
    let names: Vec<String> = set.file.iter().map(|file| file.name().to_owned()).collect();
    let bytes = names.iter().map(|name| name.len() + size_of::<String>()).sum::<usize>();
    let bytes = bytes.saturating_mul(names.len());
    if bytes > MOST_NAMES_BYTES {
        return Err(format!("it has {} files that import one another, more than are read", names.len()));
    }
    for file in &mut set.file {
        file.public_dependency.clear();
        file.weak_dependency.clear();
        file.dependency = names.iter().filter(|name| *name != file.name()).cloned().collect();
    }
    Ok(())
}

/// Takes away comments, services, extensions and options: only which fields are maps or packed matters to the
/// wire.
fn simplify(file: &mut FileDescriptorProto) {
    file.options = None;
    file.source_code_info = None;
    file.service.clear();
    file.extension.clear();
    file.message_type.iter_mut().for_each(simplify_message);
    file.enum_type.iter_mut().for_each(simplify_enum);
}

fn simplify_message(message: &mut DescriptorProto) {
    message.options = message
        .options
        .take()
        .map(|options| MessageOptions { map_entry: options.map_entry, ..MessageOptions::default() });
    message.extension.clear();
    message.extension_range.clear();
    message.oneof_decl.iter_mut().for_each(|oneof| oneof.options = None);
    for field in &mut message.field {
        field.options = field
            .options
            .take()
            .map(|options| FieldOptions { packed: options.packed, ..FieldOptions::default() });
        field.default_value = None;
    }
    message.enum_type.iter_mut().for_each(simplify_enum);
    message.nested_type.iter_mut().for_each(simplify_message);
}

fn simplify_enum(kind: &mut EnumDescriptorProto) {
    kind.options = None;
    kind.value.iter_mut().for_each(|value| value.options = None);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ingest::mcap::written::block_descriptors;

    const BLOCK: &str = "dropcheck.AccelerationBlock";

    #[test]
    fn a_syntax_that_the_linker_stops_at_is_told() {
        let mut set = FileDescriptorSet::decode(block_descriptors(true).as_slice()).unwrap();
        set.file[0].syntax = Some("editions".into());
        let told = message_type(BLOCK, &set.encode_to_vec()).unwrap_err();
        assert!(told.contains("\"editions\""), "{told}");
    }

    #[test]
    fn a_file_that_imports_for_its_importers_is_linked_whatever_it_imports() {
        let mut set = FileDescriptorSet::decode(block_descriptors(true).as_slice()).unwrap();
        let imports = |name: &str, of: &[&str]| FileDescriptorProto {
            name: Some(name.into()),
            syntax: Some("proto3".into()),
            dependency: of.iter().map(|&name| name.to_owned()).collect(),
            public_dependency: (0..).take(of.len()).collect(),
            ..FileDescriptorProto::default()
        };
        // Itself; one another; and forty files of which each imports the next twice, to which 2⁴⁰ ways lead.
        set.file.extend([imports("self", &["self"]), imports("a", &["b"]), imports("b", &["a"])]);
        for i in 0..40 {
            let next = format!("f{}", i + 1);
            set.file.push(imports(&format!("f{i}"), &[&next, &next]));
        }
        set.file.push(imports("f40", &[]));
        assert!(message_type(BLOCK, &set.encode_to_vec()).is_ok());
        set.file.extend((0..1000).map(|i| imports(&format!("g{i}"), &[])));
        assert!(message_type(BLOCK, &set.encode_to_vec()).unwrap_err().contains("more than are read"));
    }

    #[test]
    fn what_is_taken_away_does_not_matter() {
        let message = message_type(BLOCK, &block_descriptors(true)).unwrap();
        assert!(message.get_field_by_name("samples").unwrap().is_packed());
        assert!(message_type("dropcheck.None", &block_descriptors(true)).unwrap_err().contains("no message"));
    }
}
