//! How each kind of field is written and read; long lists of numbers go as whole columns.
//!
//! # Method
//! A packed list of fixed-width numbers is, on the wire, its little-endian bytes one after the other. It is therefore copied a
//! block at a time, where a generated message writes and reads number by number. What is not packed, which protobuf allows
//! too, goes the ordinary way, and so does everything that is wrong.

use prost::{
    DecodeError, Message,
    bytes::{Buf, BufMut},
    encoding::{self, DecodeContext, WireType},
};

/// A kind of field: what it is in a message, and its form on the wire.
pub trait Kind {
    /// What the message holds.
    type Value;

    /// Writes the field, unless it is what an absent one is.
    fn encode(tag: u32, value: &Self::Value, buf: &mut impl BufMut);

    /// Bytes that [`Kind::encode`] writes.
    fn encoded_len(tag: u32, value: &Self::Value) -> usize;

    /// Reads one occurrence of the field.
    ///
    /// # Errors
    /// It is not well formed.
    fn merge(
        wire_type: WireType,
        value: &mut Self::Value,
        buf: &mut impl Buf,
        context: DecodeContext,
    ) -> Result<(), DecodeError>;
}

/// Writes a kind of single value with the module of prost that serves it.
macro_rules! single {
    ($($(#[$doc:meta])* $kind:ident = $module:ident, $value:ty, $is_default:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $kind;

        impl Kind for $kind {
            type Value = $value;

            fn encode(tag: u32, value: &$value, buf: &mut impl BufMut) {
                let is_default: fn(&$value) -> bool = $is_default;
                if !is_default(value) {
                    encoding::$module::encode(tag, value, buf);
                }
            }

            fn encoded_len(tag: u32, value: &$value) -> usize {
                let is_default: fn(&$value) -> bool = $is_default;
                if is_default(value) { 0 } else { encoding::$module::encoded_len(tag, value) }
            }

            fn merge(
                wire_type: WireType,
                value: &mut $value,
                buf: &mut impl Buf,
                context: DecodeContext,
            ) -> Result<(), DecodeError> {
                encoding::$module::merge(wire_type, value, buf, context)
            }
        }
    )*};
}

single! {
    /// `string`.
    Text = string, String, |text| text.is_empty();
    /// `bool`.
    Flag = bool, bool, |flag| !flag;
    /// `uint32`.
    Count = uint32, u32, |count| *count == 0;
    /// An enum, as its number.
    Choice = int32, i32, |choice| *choice == 0;
    /// `double`; −0 is left out as 0 is, as prost does.
    Real = double, f64, |real| *real == 0.0;
}

/// A message, or none.
#[derive(Debug)]
pub struct Nested<M>(std::marker::PhantomData<M>);

impl<M: Message + Default> Kind for Nested<M> {
    type Value = Option<M>;

    fn encode(tag: u32, value: &Option<M>, buf: &mut impl BufMut) {
        if let Some(message) = value {
            encoding::message::encode(tag, message, buf);
        }
    }

    fn encoded_len(tag: u32, value: &Option<M>) -> usize {
        value.as_ref().map_or(0, |message| encoding::message::encoded_len(tag, message))
    }

    fn merge(
        wire_type: WireType,
        value: &mut Option<M>,
        buf: &mut impl Buf,
        context: DecodeContext,
    ) -> Result<(), DecodeError> {
        encoding::message::merge(wire_type, value.get_or_insert_default(), buf, context)
    }
}

/// Numbers that are copied from and to one array at a time.
const BLOCK: usize = 256;

/// Writes a kind of column whose numbers all have the same width.
macro_rules! column {
    ($($(#[$doc:meta])* $kind:ident = $module:ident, $number:ty, $width:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $kind;

        impl Kind for $kind {
            type Value = Vec<$number>;

            fn encode(tag: u32, column: &Vec<$number>, buf: &mut impl BufMut) {
                if column.is_empty() {
                    return;
                }
                encoding::encode_key(tag, WireType::LengthDelimited, buf);
                encoding::encode_varint((column.len() * $width) as u64, buf);
                let mut block = [0; BLOCK * $width];
                for numbers in column.chunks(BLOCK) {
                    let (places, _) = block.as_chunks_mut::<$width>();
                    places.iter_mut().zip(numbers).for_each(|(place, number)| *place = number.to_le_bytes());
                    buf.put_slice(&block[..numbers.len() * $width]);
                }
            }

            fn encoded_len(tag: u32, column: &Vec<$number>) -> usize {
                encoding::$module::encoded_len_packed(tag, column)
            }

            fn merge(
                wire_type: WireType,
                column: &mut Vec<$number>,
                buf: &mut impl Buf,
                context: DecodeContext,
            ) -> Result<(), DecodeError> {
                match packed(wire_type, buf, $width)? {
                    Some(bytes) => {
                        let (numbers, _) = bytes.as_chunks::<$width>();
                        column.extend(numbers.iter().map(|bytes| <$number>::from_le_bytes(*bytes)));
                        Ok(())
                    }
                    None => encoding::$module::merge_repeated(wire_type, column, buf, context),
                }
            }
        }
    )*};
}

column! {
    /// `repeated float`.
    Floats = float, f32, 4;
    /// `repeated fixed32`.
    Fixed32s = fixed32, u32, 4;
    /// `repeated fixed64`.
    Fixed64s = fixed64, u64, 8;
}

/// The bytes of a packed list; `None` leaves what is not packed to be read number by number.
fn packed(wire_type: WireType, buf: &mut impl Buf, width: usize) -> Result<Option<prost::bytes::Bytes>, DecodeError> {
    if wire_type != WireType::LengthDelimited {
        return Ok(None);
    }
    let length = encoding::decode_varint(buf)?;
    match usize::try_from(length) {
        Ok(length) if length <= buf.remaining() && length % width == 0 => Ok(Some(buf.copy_to_bytes(length))),
        // Reading past the end is how prost tells a list that is cut short.
        _ => encoding::decode_varint(&mut [].as_slice()).map(|_| None),
    }
}

/// A repeated enum, as its numbers.
#[derive(Debug)]
pub struct Choices;

impl Kind for Choices {
    type Value = Vec<i32>;

    fn encode(tag: u32, choices: &Vec<i32>, buf: &mut impl BufMut) {
        if choices.is_empty() || !choices.iter().all(|choice| is_one_byte(*choice)) {
            return encoding::int32::encode_packed(tag, choices, buf);
        }
        encoding::encode_key(tag, WireType::LengthDelimited, buf);
        encoding::encode_varint(choices.len() as u64, buf);
        let mut block = [0; BLOCK];
        for choices in choices.chunks(BLOCK) {
            block.iter_mut().zip(choices).for_each(|(place, choice)| *place = *choice as u8);
            buf.put_slice(&block[..choices.len()]);
        }
    }

    fn encoded_len(tag: u32, choices: &Vec<i32>) -> usize {
        encoding::int32::encoded_len_packed(tag, choices)
    }

    fn merge(
        wire_type: WireType,
        choices: &mut Vec<i32>,
        buf: &mut impl Buf,
        context: DecodeContext,
    ) -> Result<(), DecodeError> {
        let Some(mut bytes) = packed(wire_type, buf, 1)? else {
            return encoding::int32::merge_repeated(wire_type, choices, buf, context);
        };
        if bytes.is_ascii() {
            choices.extend(bytes.iter().map(|byte| i32::from(*byte)));
            return Ok(());
        }
        while bytes.has_remaining() {
            choices.push(encoding::decode_varint(&mut bytes)? as i32);
        }
        Ok(())
    }
}

/// Whether the number of an enum is one byte on the wire.
fn is_one_byte(choice: i32) -> bool {
    (0..0x80).contains(&choice)
}
