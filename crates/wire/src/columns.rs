//! The messages that hold columns: written out here, so that whole columns are copied. On the wire they are what the
//! `.proto` files say, which the tests hold against messages that prost generates.

use prost::{
    DecodeError, Message,
    bytes::{Buf, BufMut},
    encoding::{self, DecodeContext, WireType},
};

use crate::{
    kinds::{Choice, Choices, Count, Fixed32s, Fixed64s, Flag, Floats, Kind, Nested, Real, Text},
    v1,
};

/// Writes messages: for each field its tag, its name and its kind.
macro_rules! messages {
    ($($name:ident { $($tag:literal $field:ident: $kind:ty,)* })*) => {
        /// Their full names: what the generated code takes from here.
        #[cfg(test)]
        pub(crate) const NAMES: &[&str] = &[$(stringify!($name)),*];

        $(#[derive(Clone, Debug, Default, PartialEq)]
        #[allow(missing_docs, reason = "the .proto files carry the documentation")]
        pub struct $name {
            $(pub $field: <$kind as Kind>::Value,)*
        }

        impl Message for $name {
            fn encode_raw(&self, buf: &mut impl BufMut) {
                $(<$kind>::encode($tag, &self.$field, buf);)*
            }

            fn encoded_len(&self) -> usize {
                0 $(+ <$kind>::encoded_len($tag, &self.$field))*
            }

            fn merge_field(
                &mut self,
                tag: u32,
                wire_type: WireType,
                buf: &mut impl Buf,
                context: DecodeContext,
            ) -> Result<(), DecodeError> {
                match tag {
                    $($tag => <$kind>::merge(wire_type, &mut self.$field, buf, context).map_err(|mut error| {
                        error.push(stringify!($name), stringify!($field));
                        error
                    }),)*
                    _ => encoding::skip_field(wire_type, tag, buf, context),
                }
            }

            fn clear(&mut self) {
                *self = Self::default();
            }
        })*
    };
}

messages! {
    PoseColumns {
        1 frame_origin: Nested<v1::Vec3>,
        2 positions: Floats,
        3 rotations: Floats,
    }
    PairColumns {
        1 a: Fixed64s,
        2 b: Fixed64s,
    }
    ConvexHull {
        1 points: Floats,
    }
    TriangleMesh {
        1 vertices: Floats,
        2 indices: Fixed32s,
        3 mode: Choice,
        4 decompose: Nested<v1::Decompose>,
    }
    HeightField {
        1 columns: Count,
        2 rows: Count,
        3 heights: Floats,
        4 spacing: Nested<v1::Vec3>,
        5 holes: Fixed32s,
    }
    GeometryChunk {
        1 values: Floats,
        2 indices: Fixed32s,
    }
    Remove {
        1 ids: Fixed64s,
    }
    InsertColumns {
        1 like: Nested<v1::Shape>,
        2 ids: Fixed64s,
        3 poses: Nested<PoseColumns>,
    }
    MoveColumns {
        1 ids: Fixed64s,
        2 poses: Nested<PoseColumns>,
        3 velocities: Floats,
        4 angular_velocities: Floats,
        5 teleport: Flag,
    }
    PairsResponse {
        1 pairs: Nested<PairColumns>,
        2 verdicts: Choices,
        3 info: Nested<v1::AnswerInfo>,
        4 changes: Choices,
    }
    HitColumns {
        1 verdicts: Choices,
        2 ids: Fixed64s,
        3 values: Floats,
        4 points: Floats,
        5 normals: Floats,
        6 parts: Fixed32s,
        7 faces: Fixed32s,
        8 lower: Floats,
        9 upper: Floats,
        10 max_width: Real,
    }
    RaycastBatchRequest {
        1 session: Text,
        2 frame_origin: Nested<v1::Vec3>,
        3 origins: Floats,
        4 directions: Floats,
        5 max_distances: Floats,
        6 mode: Choice,
        7 hollow: Flag,
        8 want: Nested<v1::ColumnChoice>,
        9 options: Nested<Box<v1::QueryOptions>>,
        10 ignore_ids: Fixed64s,
        11 faces: Choice,
    }
    OverlapBatchRequest {
        1 session: Text,
        2 geometry: Nested<v1::Geometry>,
        3 poses: Nested<PoseColumns>,
        4 scales: Floats,
        5 max_hits_each: Count,
        6 options: Nested<Box<v1::QueryOptions>>,
    }
    OverlapBatchResponse {
        1 offsets: Fixed32s,
        2 ids: Fixed64s,
        3 verdicts: Choices,
        4 truncated: Fixed32s,
        5 info: Nested<v1::AnswerInfo>,
    }
    DistanceBatchRequest {
        1 session: Text,
        2 geometry: Nested<v1::Geometry>,
        3 poses: Nested<PoseColumns>,
        4 max_distances: Floats,
        5 want: Nested<v1::ColumnChoice>,
        6 options: Nested<Box<v1::QueryOptions>>,
    }
    LineOfSightRequest {
        1 session: Text,
        2 frame_origin: Nested<v1::Vec3>,
        3 eyes: Floats,
        4 points: Floats,
        5 offsets: Fixed32s,
        6 max_distances: Floats,
        7 eye_ids: Fixed64s,
        8 target_ids: Fixed64s,
        9 enough: Count,
        10 want_points: Flag,
        11 options: Nested<Box<v1::QueryOptions>>,
    }
    LineOfSightResponse {
        1 visible: Fixed32s,
        2 hidden: Fixed32s,
        3 undecided: Fixed32s,
        4 points: Choices,
        5 info: Nested<v1::AnswerInfo>,
    }
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, fmt::Debug};

    use prost::Message;
    use prost_types::{
        DescriptorProto, FileDescriptorSet,
        field_descriptor_proto::{Label, Type},
    };

    use super::*;
    use crate::reference;

    fn next(state: &mut u64) -> u64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *state >> 33
    }

    /// Bytes of random fields: packed in one or several pieces, number by number, unknown, and sometimes cut short.
    fn random_message(state: &mut u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        for _ in 0..next(state) % 8 {
            let tag = u32::try_from(next(state) % 13 + 1).expect("it is small");
            match next(state) % 8 {
                0 => {
                    encoding::encode_key(tag, WireType::ThirtyTwoBit, &mut bytes);
                    bytes.extend(next(state).to_le_bytes().iter().take(4));
                }
                1 => {
                    encoding::encode_key(tag, WireType::SixtyFourBit, &mut bytes);
                    bytes.extend(next(state).to_le_bytes());
                }
                2 => {
                    encoding::encode_key(tag, WireType::Varint, &mut bytes);
                    encoding::encode_varint(next(state) >> (next(state) % 31), &mut bytes);
                }
                _ => {
                    let width = if next(state).is_multiple_of(9) { 1 } else { 8 };
                    let length = width * (next(state) % 400);
                    encoding::encode_key(tag, WireType::LengthDelimited, &mut bytes);
                    encoding::encode_varint(length, &mut bytes);
                    let mask = if next(state).is_multiple_of(2) { 0x7f } else { 0xff };
                    bytes.extend((0..length).map(|_| next(state) as u8 & mask));
                }
            }
        }
        if next(state).is_multiple_of(10) {
            bytes.truncate(bytes.len() - bytes.len().min(3));
        }
        bytes
    }

    /// Reads the same bytes as ours and as prost's own, and compares what they write. Returns whether they were well formed.
    fn agrees<Ours: Message + Default + Debug, Theirs: Message + Default + Debug>(bytes: &[u8]) -> bool {
        match (Ours::decode(bytes), Theirs::decode(bytes)) {
            (Ok(ours), Ok(theirs)) => {
                let written = ours.encode_to_vec();
                assert_eq!(written, theirs.encode_to_vec());
                assert_eq!((ours.encoded_len(), theirs.encoded_len()), (written.len(), written.len()));
                true
            }
            (Err(ours), Err(theirs)) => {
                let place = |error: &DecodeError| error.to_string().split(": ").nth(1).map(str::to_owned);
                assert_eq!(place(&ours), place(&theirs), "{ours} and {theirs}");
                false
            }
            (ours, theirs) => panic!("{ours:?} but {theirs:?} of {bytes:?}"),
        }
    }

    macro_rules! compared {
        ($($name:ident),*) => {
            /// Names of the messages, and how many of the random ones were well formed.
            fn compared(bytes: &[u8]) -> Vec<(&'static str, bool)> {
                vec![$((stringify!($name), agrees::<$name, reference::$name>(bytes))),*]
            }
        };
    }

    compared!(
        PoseColumns,
        PairColumns,
        ConvexHull,
        TriangleMesh,
        HeightField,
        GeometryChunk,
        Remove,
        InsertColumns,
        MoveColumns,
        PairsResponse,
        HitColumns,
        RaycastBatchRequest,
        OverlapBatchRequest,
        OverlapBatchResponse,
        DistanceBatchRequest,
        LineOfSightRequest,
        LineOfSightResponse
    );

    #[test]
    fn random_bytes_are_read_and_written_as_prost_does() {
        let mut state = 11;
        let mut well_formed = 0;
        for _ in 0..4_000 {
            let compared = compared(&random_message(&mut state));
            assert_eq!(compared.iter().map(|(name, _)| *name).collect::<Vec<_>>(), NAMES);
            well_formed += compared.iter().filter(|(_, is_well_formed)| *is_well_formed).count();
        }
        let share = well_formed as f64 / (4_000.0 * NAMES.len() as f64);
        assert!((0.2..0.8).contains(&share), "{share}");
    }

    #[test]
    fn full_columns_are_the_same_bytes_as_those_of_prost() {
        let floats: Vec<f32> = (0..1000).map(|number| number as f32 * 0.37 - 90.0).collect();
        let ours = RaycastBatchRequest {
            session: "arena".to_owned(),
            origins: floats.clone(),
            directions: vec![-0.0, f32::NAN, f32::INFINITY],
            ignore_ids: (0..1000).map(|id| id << 40).collect(),
            ..RaycastBatchRequest::default()
        };
        let theirs = reference::RaycastBatchRequest {
            session: ours.session.clone(),
            origins: floats,
            directions: ours.directions.clone(),
            ignore_ids: ours.ignore_ids.clone(),
            ..reference::RaycastBatchRequest::default()
        };
        assert_eq!(ours.encode_to_vec(), theirs.encode_to_vec());
        let hits = HitColumns { verdicts: vec![0, 1, 3, 200, -1], max_width: -0.0, ..HitColumns::default() };
        let theirs = reference::HitColumns {
            verdicts: vec![0, 1, 3, 200, -1],
            max_width: -0.0,
            ..reference::HitColumns::default()
        };
        assert_eq!(hits.encode_to_vec(), theirs.encode_to_vec());
        assert_eq!(HitColumns::decode(theirs.encode_to_vec().as_slice()).expect("well formed").verdicts, hits.verdicts);
    }

    /// Lists of numbers that are short by their nature stay with prost.
    const SHORT_LISTS: [&str; 5] =
        ["DepenetrateResponse", "Filter", "NodeColumns", "WatchOverlapsRequest", "WatchWorldResponse"];

    #[test]
    fn every_message_with_columns_is_written_out_here() {
        let files = FileDescriptorSet::decode(v1::FILE_DESCRIPTOR_SET).expect("the build wrote it");
        let has_columns = |message: &&DescriptorProto| {
            message.field.iter().any(|field| {
                field.label() == Label::Repeated
                    && matches!(field.r#type(), Type::Float | Type::Fixed32 | Type::Fixed64 | Type::Enum)
            })
        };
        let messages = files.file.iter().flat_map(|file| &file.message_type).filter(has_columns);
        let found: BTreeSet<&str> = messages.map(|message| message.name()).collect();
        let known: BTreeSet<&str> = NAMES.iter().chain(&SHORT_LISTS).copied().collect();
        let missing: Vec<_> = found.difference(&known).collect();
        assert!(missing.is_empty(), "{missing:?}");
    }
}
