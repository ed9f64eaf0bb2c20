//! Paths to addresses in the file, and datasets to the addresses of their chunks (HDF5 file format
//! specification, III and IV).

use super::super::tree::LinkKind;
use hdf5_reader::Hdf5File;
use hdf5_reader::btree_v1::{BTreeV1Key, collect_btree_v1_leaves_storage};
use hdf5_reader::btree_v2::{BTreeV2Header, BTreeV2Record, collect_btree_v2_records_storage};
use hdf5_reader::chunk_index::{
    ChunkEntry, collect_implicit_chunk_entries, collect_v2_chunk_entries_storage, single_chunk_entry,
};
use hdf5_reader::error::Error;
use hdf5_reader::extensible_array::collect_extensible_array_chunk_entries_storage;
use hdf5_reader::fixed_array::collect_fixed_array_chunk_entries_storage;
use hdf5_reader::fractal_heap::FractalHeap;
use hdf5_reader::io::Cursor;
use hdf5_reader::local_heap::LocalHeap;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::layout::ChunkIndexing;
use hdf5_reader::messages::link::{self, LinkTarget};
use hdf5_reader::storage::Storage;
use hdf5_reader::symbol_table::SymbolTableNode;
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

/// Of addresses and lengths, bytes: no other file is opened.
const SIZE: u8 = 8;
/// Soft links lead to soft links so often.
const DEEPEST: usize = 16;

/// What a target is to who walks the groups.
pub(super) fn kind(target: &LinkTarget) -> LinkKind {
    match target {
        LinkTarget::Hard { .. } => LinkKind::Hard,
        LinkTarget::Soft { .. } => LinkKind::Soft,
        LinkTarget::External { .. } => LinkKind::External,
    }
}

/// What the names in a group lead to.
type Named = BTreeMap<String, LinkTarget>;

/// The links in each group, by its address.
#[derive(Default)]
pub(super) struct Links(HashMap<u64, Rc<Named>>);

impl Links {
    /// Of the group at an address.
    pub(super) fn of(&mut self, file: &Hdf5File, address: u64) -> Result<Rc<Named>, Error> {
        if let Some(links) = self.0.get(&address) {
            return Ok(links.clone());
        }
        let mut links = Named::new();
        for message in &file.get_or_parse_header(address)?.messages {
            match message {
                HdfMessage::Link(link) => {
                    links.insert(link.name.clone(), link.target.clone());
                }
                HdfMessage::LinkInfo(info) if info.fractal_heap_address != u64::MAX => {
                    let [heap, index] = [info.fractal_heap_address, info.btree_name_index_address];
                    add_of_heap(file.storage(), heap, index, &mut links)?;
                }
                HdfMessage::SymbolTable(table) => {
                    add_of_table(file.storage(), table.heap_address, table.btree_address, &mut links)?;
                }
                _ => {}
            }
        }
        let links = Rc::new(links);
        self.0.insert(address, links.clone());
        Ok(links)
    }

    /// Where an absolute path leads; `None` where into another file.
    pub(super) fn lead(&mut self, file: &Hdf5File, path: &str) -> Result<Option<u64>, Error> {
        let root = file.root_group()?.address();
        self.lead_from(file, root, path, 0)
    }

    fn lead_from(
        &mut self,
        file: &Hdf5File,
        group: u64,
        path: &str,
        depth: usize,
    ) -> Result<Option<u64>, Error> {
        let mut at = if path.starts_with('/') { file.root_group()?.address() } else { group };
        for name in path.split('/').filter(|name| !["", "."].contains(name)) {
            let links = self.of(file, at)?;
            at = match links.get(name) {
                Some(LinkTarget::Hard { address }) => *address,
                Some(LinkTarget::External { .. }) => return Ok(None),
                Some(LinkTarget::Soft { path }) if depth < DEEPEST => {
                    let Some(address) = self.lead_from(file, at, path, depth + 1)? else { return Ok(None) };
                    address
                }
                _ => return Err(Error::Other(format!("nothing stands at {path}"))),
            };
        }
        Ok(Some(at))
    }
}

/// The links of a group that has many, in a heap with an index by name.
fn add_of_heap(storage: &dyn Storage, heap: u64, index: u64, links: &mut Named) -> Result<(), Error> {
    let heap = FractalHeap::parse_at_storage(storage, heap, SIZE, SIZE)?;
    let index = BTreeV2Header::parse_at_storage(storage, index, SIZE, SIZE)?;
    for record in collect_btree_v2_records_storage(storage, &index, SIZE, SIZE, None, &[], None)? {
        let BTreeV2Record::LinkNameHash { heap_id, .. } = &record else { continue };
        let message = heap.get_object_storage(heap_id, storage, SIZE, SIZE)?;
        let link = link::parse(&mut Cursor::new(&message), SIZE, SIZE, message.len())?;
        links.insert(link.name, link.target);
    }
    Ok(())
}

/// The links of a group as the first versions of the library write them.
fn add_of_table(storage: &dyn Storage, heap: u64, index: u64, links: &mut Named) -> Result<(), Error> {
    /// Of the beginning of a node, and of each link in it, bytes.
    const NODE: [usize; 2] = [8, 40];
    let heap = LocalHeap::parse_at_storage(storage, heap, SIZE, SIZE)?;
    for (_, at) in collect_btree_v1_leaves_storage(storage, index, SIZE, SIZE, None, &[], None)? {
        let head = storage.read_range(at, NODE[0])?;
        let count = usize::from(Cursor::new(&head[6..]).read_u16_le()?);
        let node = storage.read_range(at, NODE[0] + NODE[1] * count)?;
        for entry in SymbolTableNode::parse(&mut Cursor::new(&node), SIZE, SIZE)?.entries {
            let link = if entry.cache_type == 2 {
                let path = Cursor::new(&entry.scratch).read_u32_le()?;
                LinkTarget::Soft { path: heap.get_string_storage(path.into(), storage)? }
            } else {
                LinkTarget::Hard { address: entry.object_header_address }
            };
            links.insert(heap.get_string_storage(entry.link_name_offset, storage)?, link);
        }
    }
    Ok(())
}

/// The chunks of a dataset that were written, by the index at an address.
pub(super) fn chunks(
    file: &Hdf5File,
    dataset: &hdf5_reader::Dataset,
    at: u64,
    index: Option<&ChunkIndexing>,
) -> Result<Vec<ChunkEntry>, Error> {
    let (storage, shape) = (file.storage(), dataset.shape());
    let chunk: Vec<u32> = dataset.chunks().unwrap_or_default();
    let rank = u32::try_from(shape.len()).unwrap_or(u32::MAX);
    if at == u64::MAX {
        return Ok(Vec::new());
    }
    let mut chunks = match index {
        None => {
            let leaves = collect_btree_v1_leaves_storage(storage, at, SIZE, SIZE, Some(rank), &chunk, None)?;
            leaves.into_iter().filter_map(|(key, address)| of_key(key, address, shape.len())).collect()
        }
        Some(ChunkIndexing::SingleChunk { filtered_size, filters }) => {
            vec![single_chunk_entry(at, *filtered_size, *filters, shape.len())]
        }
        Some(ChunkIndexing::BTreeV2) => {
            collect_v2_chunk_entries_storage(storage, at, SIZE, SIZE, rank, &chunk, None)?
        }
        Some(ChunkIndexing::Implicit) => {
            let bytes = dataset.raw_element_size()?;
            collect_implicit_chunk_entries(at, shape, &chunk, bytes, None, storage.len())?
        }
        Some(ChunkIndexing::FixedArray { .. }) => {
            collect_fixed_array_chunk_entries_storage(storage, at, SIZE, SIZE, shape, &chunk, None)?
        }
        Some(ChunkIndexing::ExtensibleArray { .. }) => {
            let most = dataset.max_dims();
            collect_extensible_array_chunk_entries_storage(
                storage, at, SIZE, SIZE, shape, most, &chunk, None,
            )?
        }
    };
    // Those of a dataset that was made shorter stay in the file.
    chunks.retain(|stored| stored.offsets.iter().zip(shape).all(|(from, size)| from < size));
    Ok(chunks)
}

fn of_key(key: BTreeV1Key, address: u64, rank: usize) -> Option<ChunkEntry> {
    let BTreeV1Key::RawData { chunk_size, filter_mask, offsets } = key else { return None };
    let offsets = offsets.get(..rank)?.to_vec();
    Some(ChunkEntry { address, size: chunk_size.into(), filter_mask, offsets })
}
