//! Executes functions of a shader in naga's IR on the CPU: what is pure, and fetches from textures. What needs
//! neighbouring pixels (derivatives), loops or buffers is refused by a panic that names it.

use crate::operators::{Value, binary, math, unary};
use naga::{
    Block, Expression, Function, Handle, Literal, Module, SampleLevel, ScalarKind, Statement, Type,
    TypeInner, VectorSize,
};

/// What a shader can sample, by index.
pub(crate) struct Textures<'a> {
    /// What variables of the shader are called that stand for them.
    pub(crate) names: &'a [&'a str],
    /// Width and height.
    pub(crate) sizes: &'a [[usize; 2]],
    /// The texels at (u, v) of one of them, in this layer of an array.
    pub(crate) fetch: &'a dyn Fn(usize, [f32; 2], Option<usize>) -> [f32; 4],
}

/// A module, and the memory of what runs in it.
pub(crate) struct Interpreter<'a> {
    module: &'a Module,
    textures: &'a Textures<'a>,
    /// Variables: first those of the module, then those of calls.
    memory: Vec<Value>,
}

/// A call of a function: its arguments, where its variables lie, and what was evaluated so far.
struct Frame<'a> {
    function: &'a Function,
    arguments: Vec<Value>,
    first_variable: usize,
    values: Vec<Option<Value>>,
}

/// How a block was left.
enum Left {
    AtEnd,
    ByReturn(Option<Value>),
    ByBreak,
}

impl<'a> Interpreter<'a> {
    pub(crate) fn new(module: &'a Module, textures: &'a Textures<'a>) -> Self {
        let mut new = Self { module, textures, memory: Vec::new() };
        for (_, variable) in module.global_variables.iter() {
            let value = match module.types[variable.ty].inner {
                TypeInner::Image { .. } => {
                    let name = variable.name.as_deref().unwrap_or_default();
                    let index = textures.names.iter().position(|&n| n == name);
                    Value::Texture(index.unwrap_or_else(|| panic!("no texture is called {name}")))
                }
                TypeInner::Sampler { .. } => Value::Sampler,
                _ => new.zero(variable.ty),
            };
            new.memory.push(value);
        }
        new
    }

    /// Calls a function by its name.
    pub(crate) fn call(&mut self, name: &str, arguments: Vec<Value>) -> Value {
        let mut functions = self.module.functions.iter().map(|(_, function)| function);
        let function = functions.find(|function| function.name.as_deref() == Some(name));
        let function = function.unwrap_or_else(|| panic!("the shader has no function {name}"));
        assert_eq!(function.arguments.len(), arguments.len(), "{name} has another number of parameters");
        self.run(function, arguments).unwrap_or_else(|| panic!("{name} returns nothing"))
    }

    /// Runs the module's only entry point, with inputs by name; all others are 0.
    pub(crate) fn enter(&mut self, inputs: &[(&str, Value)]) -> Value {
        let [entry] = self.module.entry_points.as_slice() else {
            panic!("the shader has not one entry point")
        };
        let parameters = &entry.function.arguments;
        for (name, _) in inputs {
            let is_there = parameters.iter().any(|parameter| parameter.name.as_deref() == Some(*name));
            assert!(is_there, "the shader has no input {name}");
        }
        let arguments = parameters.iter().map(|parameter| {
            let given = inputs.iter().find(|(name, _)| parameter.name.as_deref() == Some(*name));
            given.map_or_else(|| self.zero(parameter.ty), |(_, value)| value.clone())
        });
        let arguments = arguments.collect();
        self.run(&entry.function, arguments).expect("the entry point has outputs")
    }

    fn run(&mut self, function: &'a Function, arguments: Vec<Value>) -> Option<Value> {
        let first_variable = self.memory.len();
        let mut frame =
            Frame { function, arguments, first_variable, values: vec![None; function.expressions.len()] };
        let variables = function.local_variables.iter();
        let zeros: Vec<Value> = variables.map(|(_, variable)| self.zero(variable.ty)).collect();
        self.memory.extend(zeros);
        for (handle, variable) in function.local_variables.iter() {
            if let Some(init) = variable.init {
                self.memory[first_variable + handle.index()] = self.value(&mut frame, init);
            }
        }
        match self.block(&mut frame, &function.body) {
            Left::ByReturn(value) => value,
            _ => None,
        }
    }

    fn block(&mut self, frame: &mut Frame<'a>, block: &'a Block) -> Left {
        for statement in block.iter() {
            let left = match statement {
                Statement::Emit(range) => {
                    for handle in range.clone() {
                        frame.values[handle.index()] = None;
                        let value = self.evaluate(frame, handle);
                        frame.values[handle.index()] = Some(value);
                    }
                    Left::AtEnd
                }
                Statement::Block(inner) => self.block(frame, inner),
                Statement::If { condition, accept, reject } => {
                    let chosen = if self.value(frame, *condition).truth() { accept } else { reject };
                    self.block(frame, chosen)
                }
                // glslang wraps functions that return early in a switch with nothing but a default.
                Statement::Switch { cases, .. } if cases.len() == 1 => {
                    match self.block(frame, &cases[0].body) {
                        Left::ByBreak => Left::AtEnd,
                        left => left,
                    }
                }
                Statement::Break => Left::ByBreak,
                Statement::Return { value } => Left::ByReturn(value.map(|value| self.value(frame, value))),
                Statement::Store { pointer, value } => {
                    let value = self.value(frame, *value);
                    let pointer = self.value(frame, *pointer);
                    *self.place(&pointer) = value;
                    Left::AtEnd
                }
                Statement::Call { function, arguments, result } => {
                    let arguments = arguments.iter().map(|&argument| self.value(frame, argument)).collect();
                    let returned = self.run(&self.module.functions[*function], arguments);
                    if let Some(result) = result {
                        frame.values[result.index()] = returned;
                    }
                    Left::AtEnd
                }
                other => panic!("{other:?} is not interpreted"),
            };
            if !matches!(left, Left::AtEnd) {
                return left;
            }
        }
        Left::AtEnd
    }

    fn place(&mut self, pointer: &Value) -> &mut Value {
        let Value::Pointer(slot, path) = pointer else { panic!("{pointer:?} is no pointer") };
        path.iter().fold(&mut self.memory[*slot], |place, &index| match place {
            Value::Of(parts) => &mut parts[index],
            other => panic!("{other:?} has no parts"),
        })
    }

    fn value(&mut self, frame: &mut Frame<'a>, handle: Handle<Expression>) -> Value {
        match &frame.values[handle.index()] {
            Some(value) => value.clone(),
            None => self.evaluate(frame, handle),
        }
    }

    fn evaluate(&mut self, frame: &mut Frame<'a>, handle: Handle<Expression>) -> Value {
        match &frame.function.expressions[handle] {
            Expression::FunctionArgument(index) => frame.arguments[*index as usize].clone(),
            Expression::LocalVariable(variable) => {
                Value::Pointer(frame.first_variable + variable.index(), Vec::new())
            }
            // Textures are no places in memory: they are handed on as they are.
            Expression::GlobalVariable(variable) => match &self.memory[variable.index()] {
                opaque @ (Value::Texture(_) | Value::Sampler) => opaque.clone(),
                _ => Value::Pointer(variable.index(), Vec::new()),
            },
            Expression::Load { pointer } => {
                let pointer = self.value(frame, *pointer);
                self.place(&pointer).clone()
            }
            Expression::ImageSample { image, coordinate, array_index, level, .. } => {
                let level = match level {
                    SampleLevel::Zero => 0.0,
                    SampleLevel::Exact(level) => self.value(frame, *level).number(),
                    other => panic!("{other:?}: the maps have no mip levels"),
                };
                assert_eq!(level, 0.0, "the maps have no mip levels");
                let Value::Texture(texture) = self.value(frame, *image) else {
                    panic!("no texture is sampled")
                };
                let at = self.value(frame, *coordinate).numbers();
                let layer = array_index.map(|layer| self.value(frame, layer).number().round() as usize);
                Value::vector(&(self.textures.fetch)(texture, [at[0], at[1]], layer))
            }
            Expression::ImageQuery { image, query: naga::ImageQuery::Size { .. } } => {
                let Value::Texture(texture) = self.value(frame, *image) else {
                    panic!("no texture is asked")
                };
                Value::Of(self.textures.sizes[texture].iter().map(|&n| Value::I(n as i64)).collect())
            }
            other => self.plain(other, &mut |this, handle| this.value(frame, handle)),
        }
    }

    /// Expressions that are the same within functions and in constants.
    fn plain(
        &mut self,
        expression: &Expression,
        value: &mut dyn FnMut(&mut Self, Handle<Expression>) -> Value,
    ) -> Value {
        match expression {
            Expression::Literal(literal) => match *literal {
                Literal::F32(x) => Value::F(x),
                Literal::AbstractFloat(x) => Value::F(x as f32),
                Literal::I32(i) => Value::I(i64::from(i)),
                Literal::U32(i) => Value::I(i64::from(i)),
                Literal::AbstractInt(i) => Value::I(i),
                Literal::Bool(b) => Value::B(b),
                other => panic!("{other:?} is not interpreted"),
            },
            Expression::Constant(constant) => self.constant(self.module.constants[*constant].init),
            Expression::ZeroValue(ty) => self.zero(*ty),
            Expression::Compose { ty, components } => {
                let parts: Vec<Value> = components.iter().map(|&part| value(self, part)).collect();
                match self.module.types[*ty].inner {
                    // A vector may be composed of shorter ones.
                    TypeInner::Vector { .. } => Value::Of(
                        parts
                            .into_iter()
                            .flat_map(|p| if let Value::Of(p) = p { p } else { vec![p] })
                            .collect(),
                    ),
                    _ => Value::Of(parts),
                }
            }
            Expression::Access { base, index } => {
                let index = value(self, *index).index();
                part(value(self, *base), index)
            }
            Expression::AccessIndex { base, index } => part(value(self, *base), *index as usize),
            Expression::Splat { size, value: scalar } => {
                let scalar = value(self, *scalar);
                Value::Of(vec![scalar; lanes(*size)])
            }
            Expression::Swizzle { size, vector, pattern } => {
                let vector = value(self, *vector);
                Value::Of(pattern[..lanes(*size)].iter().map(|&i| vector.part(i as usize).clone()).collect())
            }
            Expression::Unary { op, expr } => unary(*op, &value(self, *expr)),
            Expression::Binary { op, left, right } => {
                let (left, right) = (value(self, *left), value(self, *right));
                binary(*op, &left, &right)
            }
            Expression::Select { condition, accept, reject } => {
                let (accept, reject) = (value(self, *accept), value(self, *reject));
                match value(self, *condition) {
                    Value::Of(lanes) => {
                        let chosen = lanes.iter().enumerate();
                        Value::Of(
                            chosen
                                .map(|(i, c)| (if c.truth() { &accept } else { &reject }).part(i).clone())
                                .collect(),
                        )
                    }
                    condition => {
                        if condition.truth() {
                            accept
                        } else {
                            reject
                        }
                    }
                }
            }
            Expression::Math { fun, arg, arg1, arg2, .. } => {
                let first = value(self, *arg);
                let others: Vec<Value> =
                    [arg1, arg2].into_iter().flatten().map(|&a| value(self, a)).collect();
                math(*fun, &first, &others)
            }
            Expression::As { expr, kind, .. } => convert(&value(self, *expr), *kind),
            other => panic!("{other:?} is not interpreted: it is not pure"),
        }
    }

    fn constant(&mut self, handle: Handle<Expression>) -> Value {
        let module = self.module;
        self.plain(&module.global_expressions[handle], &mut |this, handle| this.constant(handle))
    }

    fn zero(&self, ty: Handle<Type>) -> Value {
        let scalar = |kind: ScalarKind| match kind {
            ScalarKind::Float | ScalarKind::AbstractFloat => Value::F(0.0),
            ScalarKind::Bool => Value::B(false),
            _ => Value::I(0),
        };
        match &self.module.types[ty].inner {
            TypeInner::Scalar(s) => scalar(s.kind),
            TypeInner::Vector { size, scalar: s } => Value::Of(vec![scalar(s.kind); lanes(*size)]),
            TypeInner::Matrix { columns, rows, scalar: s } => {
                Value::Of(vec![Value::Of(vec![scalar(s.kind); lanes(*rows)]); lanes(*columns)])
            }
            TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. } => {
                Value::Of(vec![self.zero(*base); count.get() as usize])
            }
            TypeInner::Struct { members, .. } => {
                Value::Of(members.iter().map(|member| self.zero(member.ty)).collect())
            }
            other => panic!("a variable of {other:?} is not interpreted"),
        }
    }
}

fn part(whole: Value, index: usize) -> Value {
    match whole {
        Value::Pointer(slot, mut path) => {
            path.push(index);
            Value::Pointer(slot, path)
        }
        whole => whole.part(index).clone(),
    }
}

fn lanes(size: VectorSize) -> usize {
    size as usize
}

fn convert(value: &Value, kind: ScalarKind) -> Value {
    match value {
        Value::Of(parts) => Value::Of(parts.iter().map(|part| convert(part, kind)).collect()),
        scalar => match kind {
            ScalarKind::Float => Value::F(scalar.number()),
            ScalarKind::Sint | ScalarKind::Uint => Value::I(scalar.number() as i64),
            other => panic!("a conversion to {other:?} is not interpreted"),
        },
    }
}
