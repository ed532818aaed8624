//! Values of shaders, and arithmetic on them: componentwise, with scalars spread over vectors, in single precision.

use naga::{BinaryOperator, MathFunction, UnaryOperator};

/// What an expression of a shader evaluates to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    F(f32),
    I(i64),
    B(bool),
    /// A vector, a matrix (of columns), an array or a structure.
    Of(Vec<Value>),
    /// A place in memory: a slot, and the way from there into what is composed of parts.
    Pointer(usize, Vec<usize>),
    /// A texture, by its index; what samples it is asked for.
    Texture(usize),
    Sampler,
}

impl Value {
    pub(crate) fn vector(numbers: &[f32]) -> Self {
        Self::Of(numbers.iter().map(|&x| Self::F(x)).collect())
    }

    /// Numbers of a scalar or vector.
    pub(crate) fn numbers(&self) -> Vec<f32> {
        match self {
            Self::F(x) => vec![*x],
            Self::I(i) => vec![*i as f32],
            Self::Of(parts) => parts.iter().flat_map(Self::numbers).collect(),
            other => panic!("{other:?} has no numbers"),
        }
    }

    pub(crate) fn number(&self) -> f32 {
        match self {
            Self::F(x) => *x,
            Self::I(i) => *i as f32,
            other => panic!("{other:?} is no number"),
        }
    }

    pub(crate) fn truth(&self) -> bool {
        match self {
            Self::B(b) => *b,
            other => panic!("{other:?} is no condition"),
        }
    }

    pub(crate) fn index(&self) -> usize {
        match self {
            Self::I(i) => usize::try_from(*i).expect("indices are not negative"),
            other => panic!("{other:?} is no index"),
        }
    }

    pub(crate) fn part(&self, index: usize) -> &Value {
        match self {
            Self::Of(parts) => &parts[index],
            other => panic!("{other:?} has no parts"),
        }
    }

    fn is_matrix(&self) -> bool {
        matches!(self, Self::Of(columns) if matches!(columns.first(), Some(Self::Of(_))))
    }
}

fn each(value: &Value, f: &impl Fn(&Value) -> Value) -> Value {
    match value {
        Value::Of(parts) => Value::Of(parts.iter().map(|part| each(part, f)).collect()),
        scalar => f(scalar),
    }
}

fn both(a: &Value, b: &Value, f: &impl Fn(&Value, &Value) -> Value) -> Value {
    match (a, b) {
        (Value::Of(a), Value::Of(b)) => {
            assert_eq!(a.len(), b.len(), "operands differ in size");
            Value::Of(a.iter().zip(b).map(|(a, b)| both(a, b, f)).collect())
        }
        (Value::Of(a), b) => Value::Of(a.iter().map(|a| both(a, b, f)).collect()),
        (a, Value::Of(b)) => Value::Of(b.iter().map(|b| both(a, b, f)).collect()),
        (a, b) => f(a, b),
    }
}

fn floats(a: &Value, b: &Value, f: impl Fn(f32, f32) -> f32) -> Value {
    both(a, b, &|a, b| Value::F(f(a.number(), b.number())))
}

pub(crate) fn unary(op: UnaryOperator, value: &Value) -> Value {
    each(value, &|x| match (op, x) {
        (UnaryOperator::Negate, Value::F(x)) => Value::F(-x),
        (UnaryOperator::Negate, Value::I(x)) => Value::I(-x),
        (UnaryOperator::LogicalNot, Value::B(x)) => Value::B(!x),
        _ => panic!("{op:?} of {x:?} is not interpreted"),
    })
}

pub(crate) fn binary(op: BinaryOperator, a: &Value, b: &Value) -> Value {
    use BinaryOperator as Op;
    if op == Op::Multiply && (a.is_matrix() || b.is_matrix()) {
        return product(a, b);
    }
    both(a, b, &|a, b| match (a, b) {
        (Value::F(a), Value::F(b)) => match op {
            Op::Add => Value::F(a + b),
            Op::Subtract => Value::F(a - b),
            Op::Multiply => Value::F(a * b),
            Op::Divide => Value::F(a / b),
            Op::Less => Value::B(a < b),
            Op::LessEqual => Value::B(a <= b),
            Op::Greater => Value::B(a > b),
            Op::GreaterEqual => Value::B(a >= b),
            Op::Equal => Value::B(a == b),
            Op::NotEqual => Value::B(a != b),
            _ => panic!("{op:?} of floats is not interpreted"),
        },
        (Value::I(a), Value::I(b)) => match op {
            Op::Add => Value::I(a + b),
            Op::Subtract => Value::I(a - b),
            Op::Multiply => Value::I(a * b),
            Op::Divide => Value::I(a / b),
            _ => panic!("{op:?} of integers is not interpreted"),
        },
        (Value::B(a), Value::B(b)) => match op {
            Op::LogicalAnd => Value::B(*a && *b),
            Op::LogicalOr => Value::B(*a || *b),
            _ => panic!("{op:?} of conditions is not interpreted"),
        },
        _ => panic!("{op:?} of {a:?} and {b:?} is not interpreted"),
    })
}

/// A product in which a matrix has a part.
fn product(a: &Value, b: &Value) -> Value {
    match (a.is_matrix(), b.is_matrix(), a, b) {
        (true, true, _, Value::Of(columns)) => {
            Value::Of(columns.iter().map(|column| product(a, column)).collect())
        }
        (true, false, Value::Of(columns), Value::Of(x)) => columns
            .iter()
            .zip(x)
            .map(|(column, x)| floats(column, x, |a, b| a * b))
            .reduce(|a, b| floats(&a, &b, |a, b| a + b))
            .expect("matrices have columns"),
        (false, true, Value::Of(_), Value::Of(columns)) => {
            Value::Of(columns.iter().map(|column| Value::F(dot(a, column))).collect())
        }
        _ => floats(a, b, |a, b| a * b),
    }
}

fn dot(a: &Value, b: &Value) -> f32 {
    a.numbers().iter().zip(b.numbers()).map(|(a, b)| a * b).sum()
}

pub(crate) fn math(function: MathFunction, x: &Value, others: &[Value]) -> Value {
    use MathFunction as F;
    let of_each = |f: fn(f32) -> f32| each(x, &|x| Value::F(f(x.number())));
    match function {
        F::Abs => of_each(f32::abs),
        F::Floor => of_each(f32::floor),
        F::Sqrt => of_each(f32::sqrt),
        F::InverseSqrt => of_each(|x| 1.0 / x.sqrt()),
        F::Sign => of_each(|x| if x == 0.0 { 0.0 } else { x.signum() }),
        F::Saturate => of_each(|x| x.clamp(0.0, 1.0)),
        F::Min => floats(x, &others[0], f32::min),
        F::Max => floats(x, &others[0], f32::max),
        F::Step => floats(x, &others[0], |edge, x| if x < edge { 0.0 } else { 1.0 }),
        F::Clamp => floats(&floats(x, &others[0], f32::max), &others[1], f32::min),
        F::Fma => floats(&floats(x, &others[0], |a, b| a * b), &others[1], |a, b| a + b),
        F::Dot => Value::F(dot(x, &others[0])),
        F::Length => Value::F(dot(x, x).sqrt()),
        F::Normalize => floats(x, &Value::F(dot(x, x).sqrt()), |a, b| a / b),
        F::Cross => {
            let (a, b) = (x.numbers(), others[0].numbers());
            let [x, y, z] = [(1, 2), (2, 0), (0, 1)].map(|(i, k)| a[i] * b[k] - a[k] * b[i]);
            Value::vector(&[x, y, z])
        }
        _ => panic!("{function:?} is not interpreted"),
    }
}
